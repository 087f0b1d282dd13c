// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/vertex_colours.h"

#include <Eigen/Geometry>
#include <map>
#include <utility>

#include <catch2/catch.hpp>

#include "base/parallel.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

/// A tetrahedron with very unequal edges.
const std::vector<Vector3d> corners{{0, 0, 0}, {30, 0, 0}, {0, 20, 0}, {1, 1, 4}};
const std::vector<std::array<std::uint32_t, 3>> faces{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

/// A colour that depends on the place alone, so that faces agree at their edges.
Vector3f colour_at(const Vector3d& p) { return Vector3f(float(p.x() / 30), float(p.y() / 20), float(p.z() / 4)); }

ColouredSurface smooth_surface() {
    return {corners, faces, [](std::uint32_t t, float u, float v) {
                const Vector3d &a = corners[faces[t][0]], &b = corners[faces[t][1]], &c = corners[faces[t][2]];
                return colour_at(a + double(u) * (b - a) + double(v) * (c - a));
            }};
}

struct Measures {
    double area = 0, volume = 0, longest = 0;
    bool closed = true;
};

Measures measure(const io::ColouredMesh& mesh) {
    Measures result;
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const auto& t : mesh.triangles) {
        const Vector3d a = mesh.positions_mm[t[0]].cast<double>(), b = mesh.positions_mm[t[1]].cast<double>(),
                       c = mesh.positions_mm[t[2]].cast<double>();
        result.area += (b - a).cross(c - a).norm() / 2;
        result.volume += a.dot(b.cross(c)) / 6;
        for (std::size_t e = 0; e < 3; ++e) {
            ++edges[{t[e], t[(e + 1) % 3]}];
            result.longest =
                std::max<double>(result.longest, (mesh.positions_mm[t[e]] - mesh.positions_mm[t[(e + 1) % 3]]).norm());
        }
    }
    for (const auto& [edge, count] : edges)
        if (count != 1 || !edges.contains({edge.second, edge.first})) result.closed = false;
    return result;
}

}  // namespace

TEST_CASE("A refined surface is the same surface, closed, with short edges and the right colours") {
    const Measures before = measure({{{0, 0, 0}, {30, 0, 0}, {0, 20, 0}, {1, 1, 4}}, {}, faces});
    for (const double edge_mm : {40.0, 7.0, 1.0, 0.3}) {
        const VertexColours result = vertex_colours(smooth_surface(), {edge_mm, 400'000, 4.0 / 255});
        const Measures after = measure(result.mesh);
        INFO(edge_mm);
        CHECK(after.closed);
        CHECK(after.area == Approx(before.area).epsilon(1e-5));
        CHECK(after.volume == Approx(before.volume).epsilon(1e-5));
        CHECK(after.longest <= edge_mm * 1.00001);
        CHECK(result.longest_edge_mm == Approx(after.longest).epsilon(1e-5));
        for (std::size_t v = 0; v < result.mesh.rgb.size(); ++v)
            CHECK((result.mesh.rgb[v] - colour_at(result.mesh.positions_mm[v].cast<double>()).cwiseMax(0.0f)).norm() <
                  1e-5f);
    }
    // Nothing to do: the same faces in the same order, vertices numbered as they are met.
    const VertexColours whole = vertex_colours(smooth_surface(), {40, 1000, 0.01});
    REQUIRE(whole.mesh.triangles.size() == faces.size());
    for (std::size_t t = 0; t < faces.size(); ++t)
        for (std::size_t c = 0; c < 3; ++c)
            CHECK(whole.mesh.positions_mm[whole.mesh.triangles[t][c]] == corners[faces[t][c]].cast<float>());
}

TEST_CASE("The number of vertices stays below the limit, and near it") {
    for (const std::size_t limit : {4u, 100u, 5000u, 50000u}) {
        const VertexColours result = vertex_colours(smooth_surface(), {0.01, limit, 4.0 / 255});
        CHECK(result.mesh.positions_mm.size() <= limit);
        if (limit >= 100) CHECK(result.mesh.positions_mm.size() >= limit / 8);
        CHECK(measure(result.mesh).closed);
        CHECK(result.longest_edge_mm > 0.01);
    }
}

TEST_CASE("Where faces disagree a vertex has both colours") {
    ColouredSurface surface = smooth_surface();
    surface.colour = [](std::uint32_t t, float, float) { return t == 0 ? Vector3f(1, 0, 0) : Vector3f(0, 0, 1); };
    const VertexColours result = vertex_colours(surface, {100, 1000, 4.0 / 255});
    CHECK(result.mesh.positions_mm.size() == 3 + 4);  // three corners of face 0 twice
    for (std::size_t t = 0; t < result.mesh.triangles.size(); ++t)
        for (const std::uint32_t v : result.mesh.triangles[t])
            CHECK(result.mesh.rgb[v] == (t == 0 ? Vector3f(1, 0, 0) : Vector3f(0, 0, 1)));
    // A difference that nobody sees does not open a seam.
    surface.colour = [](std::uint32_t t, float, float) { return Vector3f::Constant(t == 0 ? 0.5f : 0.505f); };
    CHECK(vertex_colours(surface, {100, 1000, 4.0 / 255}).mesh.positions_mm.size() == 4);
}

TEST_CASE("Vertex colours are the same for any number of threads") {
    std::vector<VertexColours> runs;
    for (const std::size_t threads : {1, 4}) {
        const ThreadLimit limit(threads);
        runs.push_back(vertex_colours(smooth_surface(), {0.3, 400'000, 4.0 / 255}));
    }
    CHECK(runs[0].mesh.positions_mm == runs[1].mesh.positions_mm);
    CHECK(runs[0].mesh.rgb == runs[1].mesh.rgb);
    CHECK(runs[0].mesh.triangles == runs[1].mesh.triangles);
}

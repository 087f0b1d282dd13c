// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/parted_sheets.h"

#include <cmath>
#include <map>

#include <catch2/catch.hpp>

#include "shapes.h"

using namespace voxtone::slicer;
using Eigen::Vector3d;

namespace {

const Vector3d pitch{0.04, 0.08, 0.03};

/// A square of 4 x 4 faces in x and y, both of its sides, turned.
SolidMesh sheet(const Eigen::Affine3d& turn) {
    SolidMesh mesh;
    constexpr std::uint32_t n = 5;
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) mesh.positions_mm.push_back(turn * Vector3d(i, j, 0));
    for (std::uint32_t j = 0; j + 1 < n; ++j)
        for (std::uint32_t i = 0; i + 1 < n; ++i) {
            const std::uint32_t a = n * j + i, b = a + 1, c = a + n, d = c + 1;
            mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {a, d, c}, {a, d, b}, {a, c, d}});
        }
    return mesh;
}

SolidMesh as_mesh(const PartedSheets& parted) { return {parted.positions_mm, parted.triangles, {}}; }

/// Edges that are not used once in each direction, corners in one place being one.
int open_edges(const SolidMesh& mesh) {
    std::map<std::array<std::array<double, 3>, 2>, int> uses;
    const auto at = [&](std::uint32_t v) {
        const Vector3d& p = mesh.positions_mm[v];
        return std::array{p.x(), p.y(), p.z()};
    };
    for (const auto& t : mesh.triangles)
        for (std::size_t c = 0; c < 3; ++c) {
            const auto a = at(t[c]), b = at(t[(c + 1) % 3]);
            ++uses[{a, b}], --uses[{b, a}];
        }
    int open = 0;
    for (const auto& [edge, sum] : uses) open += sum != 0;
    return open;
}

}  // namespace

TEST_CASE("A sheet becomes a closed body as thick as its voxels, whichever way it lies") {
    for (const Vector3d& axis : {Vector3d(0, 0, 1), Vector3d(1, 0, 0), Vector3d(0.6, 0.8, 0), Vector3d(1, 2, 3)})
        for (const double angle : {0.0, 0.4, 1.1, M_PI / 2}) {
            const Eigen::Affine3d turn(Eigen::AngleAxisd(angle, axis.normalized()));
            const SolidMesh mesh = sheet(turn);
            const PartedSheets parted = part_sheets(mesh.positions_mm, mesh.triangles, pitch);
            const Vector3d n = turn.linear().col(2);
            const double thick = (n.cwiseAbs().cwiseProduct(pitch)).maxCoeff();
            INFO(axis.transpose() << ", " << angle);
            CHECK(parted.triangles.size() == mesh.triangles.size() + 2 * 16);
            CHECK(parted.rim_of.size() == 2 * 16);
            CHECK(open_edges(as_mesh(parted)) == 0);
            CHECK(shapes::volume(as_mesh(parted)) == Approx(16 * thick));
            for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {  // each side the way that it looks
                const auto& [a, b, c] = parted.triangles[t];
                const Vector3d normal = (parted.positions_mm[b] - parted.positions_mm[a])
                                            .cross(parted.positions_mm[c] - parted.positions_mm[a])
                                            .normalized();
                CHECK((parted.positions_mm[a] - mesh.positions_mm[mesh.triangles[t][0]]).dot(normal) ==
                      Approx(thick / 2));
            }
        }
}

TEST_CASE("Bodies, and sheets that lie on one, stay where they are") {
    const SolidMesh box = shapes::box({-1, -1, -2}, {6, 6, 0});
    const PartedSheets alone = part_sheets(box.positions_mm, box.triangles, pitch);
    CHECK(alone.positions_mm == box.positions_mm);
    CHECK(alone.triangles == box.triangles);
    const Eigen::Affine3d on(Eigen::Translation3d(0, 0, 0.02)), above(Eigen::Translation3d(0, 0, 1));
    const SolidMesh label = shapes::joined(box, sheet(on)), roof = shapes::joined(box, sheet(above));
    CHECK(part_sheets(label.positions_mm, label.triangles, pitch).triangles == label.triangles);
    const PartedSheets parted = part_sheets(roof.positions_mm, roof.triangles, pitch);
    CHECK(shapes::volume(as_mesh(parted)) == Approx(7 * 7 * 2 + 16 * 0.03));
}

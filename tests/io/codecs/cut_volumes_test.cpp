// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/cut_volumes.h"

#include <array>
#include <cmath>

#include <Eigen/Dense>
#include <catch2/catch.hpp>

#include "base/error.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Contains;
using Eigen::Vector3d;

namespace {

/// Adds a box; texture coordinates are x / 10 and (y + z) / 20.
TriangleRange add_box(ModelParts& parts, const Vector3d& low, const Vector3d& high, const Eigen::Vector4f& rgba) {
    const auto v = static_cast<std::uint32_t>(parts.positions.size());
    for (int i = 0; i < 8; ++i)
        parts.positions.emplace_back(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(),
                                     i & 4 ? high.z() : low.z());
    constexpr std::array<std::array<std::uint32_t, 4>, 6> sides{
        {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
    TriangleRange range{parts.triangles.size(), 0};
    for (const auto& s : sides)
        for (const std::array<std::uint32_t, 3>& corners : {std::array{s[0], s[1], s[2]}, {s[0], s[2], s[3]}}) {
            const std::size_t t = parts.add_triangle({v + corners[0], v + corners[1], v + corners[2]}, 0);
            parts.set_rgba(t, {rgba, rgba, rgba});
            std::array<Eigen::Vector2f, 3> uv;
            for (std::size_t c = 0; c < 3; ++c) {
                const Vector3d& p = parts.positions[v + corners[c]];
                uv[c] = Eigen::Vector2d(p.x() / 10, (p.y() + p.z()) / 20).cast<float>();
            }
            parts.set_uv(t, uv);
        }
    range.last = parts.triangles.size();
    return range;
}

double volume(const ModelParts& parts) {
    double six = 0;
    for (const auto& t : parts.triangles)
        six += parts.positions[t[0]].dot(parts.positions[t[1]].cross(parts.positions[t[2]]));
    return six / 6;
}

ModelParts made() {
    ModelParts parts;
    parts.materials.emplace_back();
    return parts;
}

const Eigen::Vector4f red(0.6f, 0.02f, 0.02f, 1), blue(0.02f, 0.04f, 0.6f, 1), white(1, 1, 1, 1);

}  // namespace

TEST_CASE("what is cut out of a body is gone, and what is left keeps its colours") {
    ModelParts parts = made();
    const TriangleRange other = add_box(parts, {20, 0, 0}, {21, 1, 1}, blue);
    const TriangleRange body = add_box(parts, {0, 0, 0}, {10, 10, 10}, red);
    const TriangleRange tool = add_box(parts, {5, -1, 3}, {11, 11, 7}, blue);
    cut_volumes(parts, {{{body}, {tool}}}, "a.3mf");
    CHECK(volume(parts) == Approx(1000 - 5 * 10 * 4 + 1));
    CHECK(other.first == 0);  // it is where it was
    std::size_t of_blue = 0;
    double worst = 0;
    for (std::size_t t = 0; t < parts.triangles.size(); ++t) {
        of_blue += parts.corner_rgba[t][0] == blue;
        const bool is_wall =
            parts.corner_uv[t][0] == Eigen::Vector2f::Zero() && parts.corner_uv[t][1] == Eigen::Vector2f::Zero();
        CHECK((parts.corner_rgba[t][0] == blue || parts.corner_rgba[t][0].isApprox(red)));
        if (is_wall) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            const Vector3d& p = parts.positions[parts.triangles[t][c]];
            const Eigen::Vector2d wanted(p.x() / 10, (p.y() + p.z()) / 20);
            worst = std::max(worst, (parts.corner_uv[t][c].cast<double>() - wanted).norm());
        }
    }
    CHECK(of_blue == 12);  // the other one: no wall has the tool's colour
    CHECK(worst < 1e-6);
    CHECK(parts.warnings.empty());
    for (const Vector3d& p : parts.positions) CHECK((p.y() >= 0 && p.y() <= 10));  // nothing of the tool stays
}

TEST_CASE("several tools, several bodies, and tools that hit nothing") {
    ModelParts parts = made();
    std::vector<TriangleRange> bodies, tools;
    for (const double x : {0.0, 8.0}) bodies.push_back(add_box(parts, {x, 0, 0}, {x + 10, 10, 10}, x > 0 ? red : blue));
    tools.push_back(add_box(parts, {-1, 2, 2}, {30, 4, 4}, white));
    tools.push_back(add_box(parts, {-1, 6, 6}, {30, 8, 8}, white));
    tools.push_back(add_box(parts, {100, 0, 0}, {101, 1, 1}, white));
    cut_volumes(parts, {{bodies, tools}}, "a.3mf");
    CHECK(volume(parts) == Approx(2 * (1000 - 2 * 40)));
    ModelParts all = made();
    const TriangleRange body = add_box(all, {0, 0, 0}, {1, 1, 1}, red),
                        tool = add_box(all, {-1, -1, -1}, {2, 2, 2}, red);
    cut_volumes(all, {{{body}, {tool}}}, "a.3mf");
    CHECK(all.triangles.empty());
}

TEST_CASE("walls of a cut in a body of several colours are white, and that is said") {
    ModelParts parts = made();
    const TriangleRange body = add_box(parts, {0, 0, 0}, {10, 10, 10}, red);
    for (std::size_t t = 0; t < 4; ++t) parts.set_rgba(t, {blue, blue, blue});
    const TriangleRange tool = add_box(parts, {5, 5, 5}, {11, 11, 11}, blue);
    cut_volumes(parts, {{{body}, {tool}}}, "a.3mf");
    REQUIRE(parts.warnings.size() == 1);
    CHECK_THAT(parts.warnings[0], Contains("white"));
    std::size_t walls = 0;
    for (const auto& rgba : parts.corner_rgba) walls += rgba[0] == white;
    CHECK(walls == 6);
}

TEST_CASE("a volume that is open cannot be cut, or cut others") {
    for (const bool open_tool : {false, true}) {
        ModelParts parts = made();
        TriangleRange body = add_box(parts, {0, 0, 0}, {10, 10, 10}, red);
        TriangleRange tool = add_box(parts, {5, -1, 3}, {11, 11, 7}, blue);
        --(open_tool ? tool : body).last;
        CHECK_THROWS_WITH(cut_volumes(parts, {{{body}, {tool}}}, "a.3mf"), Contains("a.3mf") && Contains("not closed"));
    }
}

TEST_CASE("a tool that touches a wall from within is cut out all the same") {
    // A prism whose edge lies in the wall x = 0, as a drill of the wall's distance does; with its end in a wall, too.
    for (const double top : {11.0, 10.0})
        for (const double bottom : {-1.0, 0.0}) {
            ModelParts parts = made();
            const TriangleRange body = add_box(parts, {0, 0, 0}, {10, 10, 10}, red);
            TriangleRange tool{parts.triangles.size(), 0};
            const auto v = static_cast<std::uint32_t>(parts.positions.size());
            for (const double z : {bottom, top})
                for (const auto& [x, y] : {std::pair{0.0, 5.0}, {2.5, 2.5}, {5.0, 5.0}, {2.5, 7.5}})
                    parts.positions.emplace_back(x, y, z);
            for (std::uint32_t i = 0; i < 4; ++i) {
                const std::uint32_t a = v + i, b = v + (i + 1) % 4;
                parts.add_triangle({a, b, b + 4}, 0);
                parts.add_triangle({a, b + 4, a + 4}, 0);
            }
            for (std::uint32_t i = 1; i < 3; ++i) {
                parts.add_triangle({v, v + i + 1, v + i}, 0);
                parts.add_triangle({v + 4, v + 4 + i, v + 5 + i}, 0);
            }
            tool.last = parts.triangles.size();
            cut_volumes(parts, {{{body}, {tool}}}, "a.3mf");
            CHECK(volume(parts) == Approx(1000 - 12.5 * 10).epsilon(1e-4));
        }
}

TEST_CASE("a volume that crosses itself is said to, and not that it is open") {
    ModelParts parts = made();
    const TriangleRange body = add_box(parts, {0, 0, 0}, {10, 10, 10}, red);
    TriangleRange tool = add_box(parts, {5, 5, 5}, {12, 12, 12}, blue);
    tool.last = add_box(parts, {4, 6, 6}, {11, 11, 11}, blue).last;
    try {
        cut_volumes(parts, {{{body}, {tool}}}, "a.3mf");
    } catch (const InputError& error) {
        CHECK_THAT(error.what(), Contains("crosses itself") && !Contains("not closed"));
    }
}

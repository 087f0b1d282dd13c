// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/polygon_triangles.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "base/error.h"

using namespace voxtone::io;

namespace {

/// Corners of even number at radius 1, of odd at `inner`.
std::vector<Eigen::Vector3d> star(std::size_t corners, double inner) {
    std::vector<Eigen::Vector3d> star;
    for (std::size_t i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * double(i) / double(corners), r = i % 2 ? inner : 1;
        star.emplace_back(r * std::cos(angle), r * std::sin(angle), 0);
    }
    return star;
}

double area_of(const std::vector<Eigen::Vector3d>& corners) {
    double twice = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) twice += corners[i].cross(corners[(i + 1) % corners.size()]).z();
    return twice / 2;
}

struct Cut {
    explicit Cut(const std::vector<Eigen::Vector3d>& corners) : of_corner(corners.size()) {
        for (const auto& [a, b, c] : polygon_triangles(corners)) {
            const double twice = (corners[b] - corners[a]).cross(corners[c] - corners[a]).z();
            area += twice / 2;
            least = std::min(least, twice);
            ++triangles;
            for (const auto corner : {a, b, c}) ++of_corner[corner];
        }
    }
    std::size_t triangles = 0;
    double area = 0, least = 1;
    std::vector<std::size_t> of_corner;  ///< triangles
};

}  // namespace

TEST_CASE("A convex face of many corners is cut without a corner that most triangles have") {
    for (const std::size_t corners : {5u, 1001u, 100000u, 1000000u}) {
        INFO(corners);
        const auto ring = star(corners, 1);
        const Cut cut(ring);
        CHECK(cut.triangles == corners - 2);
        CHECK(cut.area == Approx(area_of(ring)));
        CHECK(cut.least >= 0);
        // A halving has a corner on one side or the other: two of each length at the most.
        if (corners > 1000) CHECK(*std::ranges::max_element(cut.of_corner) <= 2 * std::size_t(std::log2(corners) + 1));
    }
}

TEST_CASE("A face of twenty thousand corners that is not convex keeps to its outline") {
    for (const double inner : {0.5, 0.9}) {
        const auto face = star(20000, inner);
        const Cut cut(face);
        CHECK(cut.triangles == face.size() - 2);
        CHECK(cut.area == Approx(area_of(face)));
        CHECK(cut.least > 0);
    }
    // Edges of all heights, so that one strip has few of them and another all.
    std::vector<Eigen::Vector3d> comb{{0, -1, 0}, {400, -1, 0}};
    for (int tooth = 200; tooth-- > 0;) {
        comb.emplace_back(2 * tooth + 1.5, tooth % 7 + 1, 0);
        comb.emplace_back(2 * tooth + 0.5, 0, 0);
    }
    const Cut cut(comb);
    CHECK(cut.triangles == comb.size() - 2);
    CHECK(cut.area == Approx(area_of(comb)));
}

TEST_CASE("A face that is not convex and has more corners than are cut in seconds is refused") {
    CHECK_THROWS_AS(polygon_triangles(star(60000, 0.5), "a.obj"), voxtone::InputError);
    CHECK_THROWS_WITH(polygon_triangles(star(60000, 0.5), "a.obj"),
                      Catch::Contains("a.obj: a face has 60000 corners") && Catch::Contains("export the model"));
}

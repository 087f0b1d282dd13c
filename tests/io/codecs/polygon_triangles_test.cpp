// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/polygon_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

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

TEST_CASE("A face is cut alike from any corner on, and from behind") {
    std::vector<std::vector<Eigen::Vector3d>> faces{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                                                    {{0, 0, 0}, {2, 0, 0.3}, {2, 1, 0}, {0, 1, 0.2}},  // not flat
                                                    star(7, 1),
                                                    star(12, 0.4)};
    for (std::vector<Eigen::Vector3d> face : faces) {
        const auto cut_of = [](const std::vector<Eigen::Vector3d>& corners) {
            std::set<std::set<std::array<double, 3>>> places;
            for (const auto& triangle : polygon_triangles(corners, "a.obj", true)) {
                std::set<std::array<double, 3>> here;
                for (const std::uint32_t c : triangle) here.insert({corners[c].x(), corners[c].y(), corners[c].z()});
                places.insert(here);
            }
            return places;
        };
        const auto first = cut_of(face);
        CHECK(first.size() == face.size() - 2);
        const double area = area_of(face);
        for (std::size_t turn = 0; turn < face.size(); ++turn) {
            std::ranges::rotate(face, face.begin() + 1);
            CHECK(cut_of(face) == first);
            std::vector<Eigen::Vector3d> behind(face.rbegin(), face.rend());
            CHECK(cut_of(behind) == first);
            double behind_area = 0;
            for (const auto& [a, b, c] : polygon_triangles(behind, "a.obj", true))
                behind_area += (behind[b] - behind[a]).cross(behind[c] - behind[a]).z() / 2;
            CHECK(behind_area == Approx(-area));
        }
    }
}

TEST_CASE("A quad that is not flat is cut along the diagonal at which it folds less") {
    // Its corner c is lifted: by the normals (0, 0, 1) and (-1, -1, 1), cos = 1 / sqrt(3), at b-d; at a-c 1/2.
    const Eigen::Vector3d a(0, 0, 0), b(1, 0, 0), c(1, 1, 1), d(0, 1, 0);
    const auto diagonal = [](const std::vector<Eigen::Vector3d>& quad) {
        const auto triangles = polygon_triangles(quad);
        REQUIRE(triangles.size() == 2);
        std::multiset<std::uint32_t> corners;
        for (const auto& triangle : triangles) corners.insert(triangle.begin(), triangle.end());
        std::vector<Eigen::Vector3d> ends;
        for (std::uint32_t i = 0; i < 4; ++i)
            if (corners.count(i) == 2) ends.push_back(quad[i]);
        return ends;
    };
    CHECK(diagonal({a, b, c, d}) == std::vector{b, d});
    CHECK(diagonal({b, c, d, a}) == std::vector{b, d});
    // Lifted as a float is rounded: flat, from its first place on.
    const Eigen::Vector3d almost(1, 1, 1e-7);
    CHECK(diagonal({a, b, almost, d}) == std::vector{a, almost});
    // A corner amid a side: no triangle without an area.
    CHECK(diagonal({a, {0.5, 0, 0}, b, d}) == std::vector<Eigen::Vector3d>{{0.5, 0, 0}, d});
}

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Against separating axes in integers: two convex bodies are apart exactly where some axis separates them, and for
// segments and triangles those normal to faces and to pairs of edges, and within the plane of a flat pair, are enough
// (S. Gottschalk, M. C. Lin, D. Manocha, "OBBTree", SIGGRAPH 1996).
#include "slicer/mesh/exact_predicates.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "base/random.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;

namespace {

using Point = Eigen::Matrix<std::int64_t, 3, 1>;
using Points = std::vector<Point>;

bool separated(const Points& a, const Points& b, const Point& axis) {
    const auto span = [&](const Points& points) {
        std::int64_t low = INT64_MAX, high = INT64_MIN;
        for (const Point& p : points) low = std::min(low, p.dot(axis)), high = std::max(high, p.dot(axis));
        return std::pair(low, high);
    };
    const auto [a_low, a_high] = span(a);
    const auto [b_low, b_high] = span(b);
    return a_high < b_low || b_high < a_low;
}

Points edges(const Points& p) {
    Points found;
    for (std::size_t n = 0; n < (p.size() == 2 ? 1 : p.size()); ++n) found.push_back(p[(n + 1) % p.size()] - p[n]);
    return found;
}

bool meet(const Points& a, const Points& b) {
    Points axes;
    Points normals;
    for (const Points* const body : {&a, &b})
        if (body->size() == 3) normals.push_back(((*body)[1] - (*body)[0]).cross((*body)[2] - (*body)[0]));
    axes = normals;
    for (const Point& e : edges(a))
        for (const Point& f : edges(b)) axes.push_back(e.cross(f));
    for (const Point& n : normals)
        for (const Points* const body : {&a, &b})
            for (const Point& e : edges(*body)) axes.push_back(n.cross(e));
    return std::none_of(axes.begin(), axes.end(), [&](const Point& axis) { return separated(a, b, axis); });
}

/// `count` points of small integers; those of a triangle are not on one line, those of a segment not one point.
Points random_points(RandomStream& random, std::size_t count, int reach) {
    for (;;) {
        Points points;
        for (std::size_t n = 0; n < count; ++n) {
            Point& p = points.emplace_back();
            for (int a = 0; a < 3; ++a) p[a] = std::int64_t(random.bits() % std::uint64_t(2 * reach + 1)) - reach;
        }
        const bool good = count == 2 ? points[0] != points[1]
                                     : (points[1] - points[0]).cross(points[2] - points[0]) != Point(0, 0, 0);
        if (good) return points;
    }
}

Vector3d place(const Point& p) { return p.cast<double>(); }
std::array<Vector3d, 3> triangle(const Points& p) { return {place(p[0]), place(p[1]), place(p[2])}; }

}  // namespace

TEST_CASE("Triangles and segments meet where no axis separates them, in integers") {
    std::size_t met = 0, apart = 0;
    for (std::uint64_t n = 0; n < 6000; ++n) {
        RandomStream random(31, n);
        const int reach = 1 + int(n % 4);  // few places: corners on edges, edges on faces, common planes
        const Points a = random_points(random, 3, reach), b = random_points(random, 3, reach),
                     s = random_points(random, 2, reach);
        const bool faces = meet(a, b), crossed = meet(s, a);
        if (triangles_meet(triangle(a), triangle(b)) != faces) CHECK(triangles_meet(triangle(a), triangle(b)) == faces);
        if (segment_meets_triangle(place(s[0]), place(s[1]), triangle(a)) != crossed)
            CHECK(segment_meets_triangle(place(s[0]), place(s[1]), triangle(a)) == crossed);
        ++(faces ? met : apart);
    }
    CHECK(met > 1000);
    CHECK(apart > 1000);
}

TEST_CASE("What touches meets, and what is the least possible apart does not") {
    const std::array<Vector3d, 3> face{Vector3d(0, 0, 1), Vector3d(4, 0, 1), Vector3d(0, 4, 1)};
    const double above = std::nextafter(1.0, 2.0);
    const Vector3d below(1, 1, 0);
    CHECK(segment_meets_triangle(below, {1, 1, 1}, face));
    CHECK_FALSE(segment_meets_triangle(below, {1, 1, std::nextafter(1.0, 0.0)}, face));
    CHECK(segment_meets_triangle(below, {1, 1, above}, face));
    // Through an edge, and just beside it.
    CHECK(segment_meets_triangle({2, 2, 0}, {2, 2, 2}, face));
    CHECK_FALSE(segment_meets_triangle({2, std::nextafter(2.0, 3.0), 0}, {2, std::nextafter(2.0, 3.0), 2}, face));
    const auto lifted = [&](double z) {
        return std::array<Vector3d, 3>{Vector3d(1, 1, z), Vector3d(2, 1, 3), Vector3d(1, 2, 3)};
    };
    CHECK(triangles_meet(face, lifted(1)));
    CHECK_FALSE(triangles_meet(face, lifted(above)));
}

TEST_CASE("Nothing meets what has no area or no length") {
    const std::array<Vector3d, 3> face{Vector3d(0, 0, 0), Vector3d(4, 0, 0), Vector3d(0, 4, 0)},
        line{Vector3d(1, 1, -1), Vector3d(1, 1, 0), Vector3d(1, 1, 1)};
    CHECK_FALSE(triangles_meet(face, line));
    CHECK_FALSE(triangles_meet(line, face));
    CHECK_FALSE(segment_meets_triangle({1, 1, -1}, {1, 1, 1}, line));
    CHECK_FALSE(segment_meets_triangle({1, 1, 0}, {1, 1, 0}, face));
    CHECK(segment_meets_triangle({1, 1, -1}, {1, 1, 1}, face));
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/decal.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <catch2/catch.hpp>

using namespace voxtone::io;
using Eigen::Vector3d;
using Eigen::Vector4f;

namespace {

constexpr float nothing = std::numeric_limits<float>::infinity();

/// 4 x 2 pixels, opaque, red from the left and green from the top: 0.1, 0.2, 0.3, 0.4 and 0.5, 0.7.
std::shared_ptr<const AlphaPicture> ramp() {
    std::vector<AlphaPicture::Pixel> pixels;
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 4; ++x)
            pixels.push_back({std::uint16_t(6553.5 * (x + 1)), std::uint16_t(6553.5 * (y ? 7 : 5)), 0, 65535});
    return std::make_shared<const AlphaPicture>(4, 2, pixels);
}

/// 8 x 4 mm, its lower left corner at (1, 2, 3), seen from +y: to the right is -x, up is +z.
Decal decal() {
    Decal one;
    one.picture = ramp();
    one.width_mm = 8, one.height_mm = 4;
    one.corner_mm = {1, 2, 3};
    one.right = -Vector3d::UnitX(), one.up = Vector3d::UnitZ(), one.out = Vector3d::UnitY();
    return one;
}

/// The place so far to the right and up on the decal, and so deep below it.
Vector3d place(double right, double up, double depth = 0) { return {1 - right, 2 - depth, 3 + up}; }

constexpr double fine = 1e-6;  // mm between samples

}  // namespace

TEST_CASE("A decal lies upright where it is seen from, its picture's top up", "[models]") {
    const Decal one = decal();
    const Vector3d normal = Vector3d::UnitY();
    for (int x = 0; x < 4; ++x) {
        const Vector4f above = one.at(place(2 * x + 1, 3), normal, fine),
                       below = one.at(place(2 * x + 1, 1), normal, fine);
        CHECK(above.x() == Approx(0.1 * (x + 1)).margin(1e-4));
        CHECK(below.x() == Approx(0.1 * (x + 1)).margin(1e-4));
        CHECK(above.y() == Approx(0.5).margin(1e-4));
        CHECK(below.y() == Approx(0.7).margin(1e-4));
        CHECK(above.w() == 1);
    }
    // However deep, where no map says what is hit first.
    CHECK(one.at(place(1, 3, 50), normal, fine) == one.at(place(1, 3), normal, fine));
    for (const auto& [right, up] :
         {std::pair{-0.1, 1.0}, std::pair{8.1, 1.0}, std::pair{1.0, -0.1}, std::pair{1.0, 4.1}})
        CHECK(one.at(place(right, up), normal, fine) == Vector4f::Zero());
}

TEST_CASE("Samples far apart see a mean of a decal's pixels", "[models]") {
    const Decal one = decal();
    // A pixel is 2 mm along both: 4 mm are two of them.
    CHECK(one.at(place(2, 2), Vector3d::UnitY(), 4).x() == Approx(0.15).margin(1e-4));
    CHECK(one.at(place(2, 2), Vector3d::UnitY(), 4).y() == Approx(0.6).margin(1e-4));
    CHECK(one.at(place(1, 3), Vector3d::UnitY(), 2).x() == Approx(0.1).margin(1e-4));
}

TEST_CASE("A decal is not smeared over what it sees from the side", "[models]") {
    const Decal one = decal();
    const auto seen = [&](double degrees) {
        const double a = degrees * std::numbers::pi / 180;
        return one.at(place(3, 2), {std::sin(a), std::cos(a), 0}, fine).w() > 0;
    };
    CHECK(seen(0));
    CHECK(seen(74.9));
    CHECK_FALSE(seen(75.1));
    CHECK_FALSE(seen(90));
    CHECK(seen(180));  // a normal either way
}

TEST_CASE("Of what lies behind one another a decal covers the first", "[models]") {
    Decal one = decal();
    one.slack_mm = 0.1;
    // On the left half depth 1, on the right half 3, and nothing at the right end.
    one.first_hit = {5, 2, {1, 1, 3, 3, nothing, 1, 1, 3, 3, nothing}};
    const auto covers = [&](double right, double depth) {
        return one.at(place(right, 2, depth), Vector3d::UnitY(), fine).w() > 0;
    };
    for (const double depth : {0.95, 1.0, 1.05}) CHECK(covers(1, depth));
    for (const double depth : {0.85, 1.15, 3.0}) CHECK_FALSE(covers(1, depth));
    for (const double depth : {2.95, 3.05}) CHECK(covers(5, depth));
    for (const double depth : {1.0, 2.85, 3.15}) CHECK_FALSE(covers(5, depth));
    // Where the depth jumps anything between the two may be the first.
    for (const double depth : {0.95, 2.0, 3.05}) CHECK(covers(3, depth));
    for (const double depth : {0.85, 3.15}) CHECK_FALSE(covers(3, depth));
    CHECK(covers(7, 3));  // beside nothing
    one.first_hit.depth_mm.assign(10, nothing);
    CHECK_FALSE(covers(1, 1));
}

TEST_CASE("The deepest of the four depths around a place", "[models]") {
    const DepthMap map{3, 3, {1, 2, 3, 4, 5, 6, 7, 8, nothing}};
    CHECK(map.deepest_near(0, 0) == 5);
    CHECK(map.deepest_near(0.49f, 0.49f) == 5);
    CHECK(map.deepest_near(0.51f, 0) == 6);
    CHECK(map.deepest_near(0, 0.51f) == 8);
    CHECK(map.deepest_near(1, 1) == 8);
    CHECK(map.deepest_near(-1, 2) == 8);
    CHECK(std::isinf(DepthMap{2, 2, {nothing, nothing, nothing, nothing}}.deepest_near(0.5f, 0.5f)));
}

TEST_CASE("A decal by texture coordinates lies within a rectangle of them", "[models]") {
    Decal one;
    one.picture = ramp();
    one.by_uv = true;
    one.corner_mm = {0.25, 0.5, 0};
    one.width_mm = 0.5, one.height_mm = 0.25;
    CHECK(one.at_uv({0.25f + 0.0625f, 0.5f + 0.1875f}, 1e-6).x() == Approx(0.1).margin(1e-4));
    CHECK(one.at_uv({0.25f + 0.0625f, 0.5f + 0.1875f}, 1e-6).y() == Approx(0.5).margin(1e-4));
    CHECK(one.at_uv({0.25f + 0.4375f, 0.5f + 0.0625f}, 1e-6).x() == Approx(0.4).margin(1e-4));
    CHECK(one.at_uv({0.25f + 0.4375f, 0.5f + 0.0625f}, 1e-6).y() == Approx(0.7).margin(1e-4));
    for (const Eigen::Vector2f& uv : {Eigen::Vector2f(0.24f, 0.6f), {0.76f, 0.6f}, {0.5f, 0.49f}, {0.5f, 0.76f}})
        CHECK(one.at_uv(uv, 1e-6) == Vector4f::Zero());
}

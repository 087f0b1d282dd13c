// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/camera/sky.h"

#include <cmath>
#include <numbers>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "optics/camera/camera.h"

using namespace voxtone;
using namespace voxtone::optics;

namespace {
constexpr double pi = std::numbers::pi;
}

TEST_CASE("skies light a plane that looks up as much as a diffuser of radiance 1 sends out") {
    for (const Sky& sky : {overcast_sky(), studio_sky(), even_sky()})
        CHECK(luminance(sky.irradiance({0, 0, 1})) == Approx(pi).epsilon(2e-3));
}

TEST_CASE("the overcast sky follows its law") {
    const Sky sky = overcast_sky();
    const auto at = [&](double height) { return sky.radiance({std::cos(height), 0, std::sin(height)})[0]; };
    CHECK(at(pi / 2 - 0.01) / at(0.006) == Approx(3).epsilon(0.03));
    CHECK(at(pi / 6) / at(pi / 2 - 0.01) == Approx(2.0 / 3).epsilon(0.01));
    CHECK(at(-0.1) == 0);
    // Irradiance of a vertical plane: (1/2 + 4/(3 pi)) / (7/3) of a level one (integral of the law).
    CHECK(sky.irradiance({0, 1, 0})[1] / sky.irradiance({0, 0, 1})[1] ==
          Approx((0.5 + 4 / (3 * pi)) / (7.0 / 3)).epsilon(0.01));
}

TEST_CASE("directions are drawn with the density that the sky says") {
    const Sky sky = studio_sky();
    RandomStream random(1, 2);
    // The mean of 1 / density over drawn directions is the solid angle that gives light.
    double sum = 0, squares = 0, light = 0;
    constexpr int n = 20000;
    for (int i = 0; i < n; ++i) {
        const double pixel = random.uniform(), u = random.uniform(), v = random.uniform();
        const Point d = sky.draw(pixel, u, v);
        CHECK(dot(d, d) == Approx(1));
        const double x = 1 / sky.density(d);
        sum += x, squares += x * x;
        light += luminance(sky.radiance(d)) * std::max(0.0, d[2]) / sky.density(d);
    }
    const double mean = sum / n, error = std::sqrt((squares / n - mean * mean) / n);
    double solid = 0;
    for (int i = 0; i < 400; ++i)
        for (int k = 0; k < 400; ++k) {
            const double z = -1 + (i + 0.5) / 200, a = 2 * pi * (k + 0.5) / 400, r = std::sqrt(1 - z * z);
            solid += sky.density({r * std::cos(a), r * std::sin(a), z}) > 0 ? 4 * pi / 160000 : 0;
        }
    CHECK(std::abs(mean - solid) < 4 * error + 0.03);
    CHECK(light / n == Approx(pi).epsilon(0.01));
}

TEST_CASE("a turned sky shines from elsewhere") {
    const Sky sky = studio_sky(), turned = sky.turned(90);
    for (const double a : {0.1, 1.3, 2.9, 4.4, 5.8})
        for (const double h : {0.2, 0.9}) {
            const Point d{std::cos(h) * std::cos(a), std::cos(h) * std::sin(a), std::sin(h)};
            CHECK(turned.radiance({-d[1], d[0], d[2]}) == sky.radiance(d));
        }
}

TEST_CASE("a camera shows right on the right, up above, and as large as its focal length says") {
    CameraView view;
    view.position = {0, -100, 0};
    view.focal_mm = 50;
    view.width_px = 360;
    view.height_px = 240;
    const Camera camera(view);
    const auto middle = camera.picture_of({0, 0, 0}), right = camera.picture_of({10, 0, 0}),
               above = camera.picture_of({0, 0, 10});
    CHECK(middle[0] == Approx(180));
    CHECK(middle[1] == Approx(120));
    CHECK(right[0] == Approx(180 + 360 * 50 * 0.1 / 36));
    CHECK(above[1] == Approx(120 - 360 * 50 * 0.1 / 36));
    const Point d = camera.direction(right[0], right[1]);
    CHECK(d[0] / d[1] == Approx(0.1));
    CHECK_THROWS(Camera(CameraView{.position = {1, 2, 3}, .target = {1, 2, 3}}));
    CHECK_THROWS(Camera(CameraView{.position = {0, 0, 9}, .target = {0, 0, 0}}));
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/photo/patch_sampling.h"

#include <cmath>
#include <numbers>

#include <catch2/catch.hpp>

#include "base/random.h"

using namespace voxtone;
using namespace voxtone::calibration;

namespace {

/// A slanted plane of light with noise, 100 x 100 pixels; `dirty` of all rows are bright.
io::Photograph slanted(double noise, double dirty) {
    io::Photograph photo{"slanted", 100, 100, io::SampleCoding::linear, 16, {}};
    for (std::uint32_t y = 0; y < 100; ++y)
        for (std::uint32_t x = 0; x < 100; ++x) {
            RandomStream random(7, y * 100 + x);
            Eigen::Vector3f value(0.4f, 0.2f, 0.02f);
            value *= float(1 + 0.002 * (x - 49.5) + 0.001 * (y - 49.5));
            for (float& v : value) v += float(noise * std::sqrt(12.0) * (random.uniform() - 0.5));
            if (y % 100 < 100 * dirty) value = Eigen::Vector3f::Constant(0.8f);
            photo.pixels.push_back(value);
        }
    return photo;
}

const Rectification identity{Eigen::Matrix3d::Identity()};
const Area middle{{20, 20}, {80, 80}};
const Eigen::Vector3d no_clip = Eigen::Vector3d::Constant(2);

}  // namespace

TEST_CASE("the mean of a slanted area is its value in the middle, its error what the noise says") {
    const AreaSample sample = sample_area(slanted(0.01, 0), identity, middle, no_clip);
    REQUIRE(sample.complete);
    CHECK(sample.pixels == 3600);
    const double expected = 0.01 / 60;
    for (int channel = 0; channel < 3; ++channel) {
        CHECK(std::abs(sample.mean[channel] - std::array{0.4, 0.2, 0.02}[std::size_t(channel)]) < 4 * expected);
        // Noise of the mean, and the allowance for dirt that noise hides: 0.15 of the spread of blocks of 9 pixels.
        CHECK(sample.error[channel] == Approx(std::hypot(expected, 0.15 * 0.01 / 3)).epsilon(0.2));
    }
    CHECK(sample.rejected < 0.05);
}

TEST_CASE("dirt is left out, and a plain mean would have seen it") {
    const io::Photograph photo = slanted(0.002, 0.35);  // 15 of the 60 rows of the area
    const AreaSample sample = sample_area(photo, identity, middle, no_clip);
    CHECK(std::abs(sample.mean[2] - 0.02) < 3e-4);
    CHECK(sample.rejected == Approx(0.25).margin(0.05));
    double plain = 0;
    for (std::uint32_t y = 20; y < 80; ++y)
        for (std::uint32_t x = 20; x < 80; ++x) plain += photo.pixels[photo.index(x, y)][2] / 3600;
    CHECK(plain > 0.2);
}

TEST_CASE("areas beyond the picture or too small are not complete, clipped pixels are counted") {
    const io::Photograph photo = slanted(0, 0.35);
    CHECK_FALSE(sample_area(photo, identity, {{60, 60}, {101, 90}}, no_clip).complete);
    CHECK_FALSE(sample_area(photo, identity, {{60, 60}, {66, 66}}, no_clip).complete);
    CHECK(sample_area(photo, identity, middle, Eigen::Vector3d::Constant(0.7)).clipped[1] == Approx(0.25).margin(1e-9));
}

TEST_CASE("what noise adds that is cut off at 0 is told, from the share of it that is") {
    // Normal noise of 0.01 about a level of so many deviations: cut at 0, E max(0, x) = level Phi(u) + s phi(u).
    constexpr double s = 0.01;
    for (const double u : {0.5, 1.0, 2.0}) {
        io::Photograph photo{"dark", 200, 200, io::SampleCoding::linear, 16, {}};
        for (std::uint32_t i = 0; i < 200 * 200; ++i) {
            RandomStream random(3, i);
            const double r = std::sqrt(-2 * std::log(1 - random.uniform()));
            const double z = r * std::cos(2 * std::numbers::pi * random.uniform());
            photo.pixels.push_back(Eigen::Vector3f::Constant(static_cast<float>(std::max(0.0, s * (u + z)))));
        }
        const AreaSample sample = sample_area(photo, identity, {{10, 10}, {190, 190}}, no_clip);
        const double below = 0.5 * std::erfc(u / std::sqrt(2.0)),
                     density = std::exp(-0.5 * u * u) / std::sqrt(2 * std::numbers::pi);
        const double excess = s * (density - u * below);
        INFO(u << " deviations: " << sample.at_zero[1] << " at 0 for " << below << ", " << sample.zero_excess[1]
               << " too much for " << excess);
        const double sampled = 1 / std::sqrt(double(sample.pixels));
        CHECK(std::abs(sample.at_zero[1] - below) < 4 * std::sqrt(below) * sampled);
        CHECK(std::abs(sample.mean[1] - s * u - excess) < 4 * s * sampled + sample.error[1]);
        CHECK(sample.zero_excess[1] == Approx(excess).epsilon(0.1));
    }
}

TEST_CASE("floats clip where their largest value is found many times") {
    io::Photograph photo = slanted(0.01, 0);
    photo.bits = 32;
    CHECK(std::isinf(clipping_level(photo)[0]));
    for (std::size_t i = 0; i < 500; ++i) photo.pixels[i][1] = 1.7f;
    CHECK(clipping_level(photo)[1] == Approx(1.7).epsilon(0.01));
    photo.bits = 16;
    CHECK(clipping_level(photo)[2] < 1);
}

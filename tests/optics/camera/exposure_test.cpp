// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a picture tells of its own noise, where the noise is known by hand.
#include "optics/camera/exposure.h"

#include <cmath>

#include <catch2/catch.hpp>

#include "optics/camera/camera_paths.h"

using namespace voxtone;
using namespace voxtone::optics;

TEST_CASE("standard errors are those of samples that see light or none by the toss of a coin") {
    // The light's edge runs down the middle of a column of pixels: a sample is 0 or 1, its variance a quarter.
    const Sky halves(2, 1, {{1, 1, 1}, {0, 0, 0}});
    CameraScene scene;
    scene.view.position = {0, 0, 0}, scene.view.target = {1, 0, 0};
    scene.view.focal_mm = 1e5;
    scene.view.width_px = 1, scene.view.height_px = 3000;
    scene.sky = &halves;
    for (const std::uint32_t samples : {8u, 12u, 32u}) {
        Progress progress;
        const CameraPicture picture =
            take_picture(scene, {.samples = samples, .seed = samples, .filter_px = 0}, progress);
        double mean = 0, told = 0, told_of_colour = 0, differ = 0;
        const auto n = static_cast<double>(picture.value.size());
        for (std::size_t i = 0; i < picture.value.size(); ++i) {
            const double off = static_cast<double>(picture.value[i]) - 0.5;
            mean += off / n;
            differ += off * off / n;
            told += std::pow(static_cast<double>(picture.standard_error[i]), 2) / n;
            told_of_colour += std::pow(static_cast<double>(picture.colour_error[i]), 2) / n;
        }
        const double variance = 0.25 / samples;
        INFO(samples << " samples: variance " << variance << ", pixels differ by " << differ << ", they tell " << told);
        // All channels of a pixel see one light: 3000 independent values. A pixel's own estimate from b bundles of four
        // has a relative variance of at most 2 / (b - 1).
        CHECK(std::abs(mean) < 4 * std::sqrt(variance / 3000));
        CHECK(differ == Approx(variance).epsilon(4 * std::sqrt(2.0 / 3000)));
        CHECK(told == Approx(variance).epsilon(4 * std::sqrt(2.0 / (samples / 4 - 1) / 3000)));
        CHECK(told_of_colour == Approx(told).epsilon(1e-5));
    }
}

TEST_CASE("standard errors of gathered pixels know that the filter's weights scatter") {
    // Left of the middle all is light, right of it nothing: samples of a pixel are all alike, and what varies from row
    // to row is how much the filter gives to those that happen to lie near the edge.
    const Sky halves(2, 1, {{1, 1, 1}, {0, 0, 0}});
    CameraScene scene;
    scene.view.position = {0, 0, 0}, scene.view.target = {1, 0, 0};
    scene.view.focal_mm = 1e5;
    scene.view.width_px = 2, scene.view.height_px = 3000;
    scene.sky = &halves;
    Progress progress;
    const CameraPicture picture = take_picture(scene, {.samples = 16, .seed = 3, .filter_px = 0.5}, progress);
    const std::size_t channels = picture.value.size() / 6000;
    double mean = 0, square = 0, told = 0;
    for (std::size_t row = 0; row < 3000; ++row) {
        const double value = static_cast<double>(picture.value[2 * row * channels]);
        mean += value / 3000, square += value * value / 3000;
        told += std::pow(static_cast<double>(picture.standard_error[2 * row * channels]), 2) / 3000;
    }
    const double differ = square - mean * mean;
    INFO("mean " << mean << ", variance " << differ << ", told " << told);
    CHECK(mean > 0.6);
    CHECK(mean < 0.99);
    // A row shares samples with the two beside it: some 1000 independent values.
    CHECK(told == Approx(differ).epsilon(4 * std::sqrt(2.0 / 1000)));
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/rehearsal/profile_simulation.h"

#include <cmath>
#include <numbers>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "calibration/spot/profile_plot.h"
#include "spot_samples.h"
#include "tests/same_for_threads.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;

namespace {

std::string fault(void (*change)(SpotCamera&)) {
    SpotCamera camera = small_camera();
    change(camera);
    try {
        camera.validate();
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

}  // namespace

TEST_CASE("A spot seen through blur and pixel is the Gaussian that it must be") {
    SpotCamera camera = small_camera();
    camera.spot_mm = 0;
    const SpotScene scene(gaussian_side(camera.grid()), camera);
    for (std::size_t c = 0; c < 3; ++c) {
        const double s = 0.3 + 0.1 * static_cast<double>(c), total = 0.5 + 0.1 * static_cast<double>(c);
        const double variance = s * s + camera.blur_mm * camera.blur_mm + camera.mm_per_px * camera.mm_per_px / 12;
        for (double r = 0; r < 1; r += 0.0137)
            CHECK(scene.light(c, r) ==
                  Approx(total / (2 * std::numbers::pi * variance) * std::exp(-r * r / (2 * variance))).epsilon(2e-5));
        CHECK(scene.truth(c, 0.05, 7).light[3] == scene.light(c, 3 * 0.05));
        CHECK(scene.truth(c, 0.05, 7).total == Approx(total));
    }
}

TEST_CASE("An even disc blurs as its width says") {
    // Second moments add: a disc of radius a has a^2 / 2.
    SpotCamera camera = small_camera();
    const auto second_moment = [&](double spot_mm) {
        camera.spot_mm = spot_mm;
        const SpotScene scene(gaussian_side(camera.grid()), camera);
        double sum = 0, light = 0;
        for (double r = 0.0005; r < 2.4; r += 0.001)
            sum += r * r * r * scene.light(0, r), light += r * scene.light(0, r);
        return sum / light;
    };
    CHECK(second_moment(0.3) - second_moment(0) == Approx(0.3 * 0.3 / 2).epsilon(2e-3));
}

TEST_CASE("The camera counts light, saturates, steps and is dark without it") {
    SpotCamera camera = small_camera();
    camera.full_well = 0, camera.stray = 0.01, camera.bits = 12;
    const SpotScene scene(gaussian_side(camera.grid()), camera);
    const Exposure short_one = scene.photograph(0, true), long_one = scene.photograph(2, true),
                   dark = scene.photograph(2, false);
    CHECK(short_one.seconds == 0.1);
    CHECK(short_one.photograph.exposure_s == 0.1);
    float highest = 0;
    const Exposure short_dark = scene.photograph(0, false);
    Eigen::Vector3d light = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < short_one.photograph.pixels.size(); ++i) {
        const Eigen::Vector3f &a = short_one.photograph.pixels[i], &b = long_one.photograph.pixels[i],
                              &d = dark.photograph.pixels[i];
        highest = std::max(highest, a.maxCoeff());
        for (int c = 0; c < 3; ++c) {
            const double steps = double{a[c]} * 4095;
            CHECK(std::abs(steps - std::round(steps)) < 1e-3);
            CHECK(b[c] <= 1);
            CHECK(d[c] >= 0.01f - 0.5f / 4095);
            // 16 times the light: steps are half a step off at most, 16 times that in the short one.
            if (b[c] < 1)
                CHECK(std::abs((double{b[c]} - camera.black) - 16 * (double{a[c]} - camera.black)) < 17 * 0.51 / 4095);
        }
        light += (a - short_dark.photograph.pixels[i]).cast<double>();
    }
    CHECK(highest == Approx(0.7 * 1.01 + 0.01).epsilon(0.02));  // peak, stray light, black; pixels are not at the peak
    // All of the spot is in the picture: channels count as their slab sends back, 0.5, 0.6 and 0.7 of the light.
    CHECK(light[1] / light[0] == Approx(0.6 / 0.5).epsilon(0.01));
    CHECK(light[2] / light[0] == Approx(0.7 / 0.5).epsilon(0.01));
    // Stray light falls off across the picture.
    CHECK(dark.photograph.pixels[dark.photograph.index(0, 60)][0] >
          dark.photograph.pixels[dark.photograph.index(119, 60)][0] + 0.05f);
}

TEST_CASE("Noise is shot and read noise, the same for any number of threads") {
    SpotCamera camera = small_camera();
    camera.full_well = 1000, camera.read_noise = 0.01, camera.stray = 0.2, camera.black = 0.1;
    const SpotScene noisy(gaussian_side(camera.grid()), camera);
    const auto pixels = test::same_for_threads([&] { return noisy.photograph(0, false).photograph.pixels; });
    CHECK(pixels != noisy.photograph(0, true).photograph.pixels);
    camera.full_well = 0;
    const Exposure clean = SpotScene(gaussian_side(camera.grid()), camera).photograph(0, false);
    double chi2 = 0;
    const std::size_t n = pixels.size();
    for (std::size_t i = 0; i < n; ++i)
        for (int c = 0; c < 3; ++c) {
            const double level = double{clean.photograph.pixels[i][c]} - 0.1, off = double{pixels[i][c]} - level - 0.1;
            chi2 += off * off / (level / 1000 + 1e-4);
        }
    const double samples = 3 * static_cast<double>(n);
    CHECK(std::abs(chi2 / samples - 1) < 4 * std::sqrt(2 / samples));
}

TEST_CASE("A slab's coefficients begin with its albedos, sets and cameras that cannot be are refused") {
    const SpotCamera camera = small_camera();
    const optics::HankelGrid grid(1, 16);
    const SlabProfiles slab = slab_profiles(optics::vero_opaque(), "K", 0.75, grid, 4096, 1);
    for (std::size_t c = 0; c < 3; ++c) {
        CHECK(slab.R[c].size() == 16);
        CHECK(slab.R[c][0] > 0);
        CHECK(slab.R[c][0] + slab.T[c][0] < 0.2);  // black
    }
    CHECK_THROWS_WITH(slab_profiles(optics::vero_opaque(), "K", 0, grid, 64, 1), Contains("0 mm thick"));
    CHECK_THROWS_AS(slab_profiles(optics::vero_opaque(), "Q", 1, grid, 64, 1), InputError);
    optics::ResinSet spectral = optics::vero_opaque();
    spectral.channels.wavelengths_nm = {450, 550, 650};
    CHECK_THROWS_WITH(slab_profiles(spectral, "K", 1, grid, 64, 1), Contains("wavelengths"));

    CHECK(fault([](SpotCamera&) {}) == "accepted");
    CHECK_THAT(fault([](SpotCamera& c) { c.seconds.clear(); }), Contains("no exposure"));
    CHECK_THAT(fault([](SpotCamera& c) { c.seconds = {1, 1}; }), Contains("exposure time is 1"));
    CHECK_THAT(fault([](SpotCamera& c) { c.size_px = 10; }), Contains("size") && Contains("10"));
    CHECK_THAT(fault([](SpotCamera& c) { c.mm_per_px = 0; }), Contains("mm per pixel"));
    CHECK_THAT(fault([](SpotCamera& c) { c.offset_px = {0, -60}; }), Contains("offset"));
    CHECK_THAT(fault([](SpotCamera& c) { c.spot_mm = -1; }), Contains("spot"));
    CHECK_THAT(fault([](SpotCamera& c) { c.stretch = 3; }), Contains("stretch"));
    CHECK_THAT(fault([](SpotCamera& c) { c.blur_mm = 0; }), Contains("blur"));
    CHECK_THAT(fault([](SpotCamera& c) { c.stray = 2; }), Contains("stray"));
    CHECK_THAT(fault([](SpotCamera& c) { c.peak = 0; }), Contains("peak"));
    CHECK_THAT(fault([](SpotCamera& c) { c.full_well = -1; }), Contains("full well"));
    CHECK_THAT(fault([](SpotCamera& c) { c.read_noise = 1; }), Contains("read noise"));
    CHECK_THAT(fault([](SpotCamera& c) { c.black = 1; }), Contains("black"));
    CHECK_THAT(fault([](SpotCamera& c) { c.bits = 7; }), Contains("bits"));
}

TEST_CASE("Profiles are drawn: a line per channel and side, a band where errors are known") {
    const SpotCamera camera = small_camera();
    const SpotScene scene(gaussian_side(camera.grid()), camera);
    io::ProfileFile file{"a<b", "", {}, {}};
    for (std::size_t c = 0; c < 3; ++c)
        file.by_channel.push_back({1, scene.truth(c, 0.05, 20), scene.truth(c, 0.05, 20)});
    const auto count = [](const std::string& text, const std::string& word) {
        std::size_t n = 0;
        for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
        return n;
    };
    std::string svg = profile_plot(file);
    CHECK(count(svg, "<polyline") == 6);
    CHECK(count(svg, "<polygon") == 0);
    CHECK_THAT(svg, Contains("a&lt;b: transmitted") && Contains("xmlns"));
    for (auto& channel : file.by_channel) channel.R.error.assign(20, 0.001), channel.T = {}, channel.thickness_mm = 0;
    svg = profile_plot(file);
    CHECK(count(svg, "<polyline") == 3);
    CHECK(count(svg, "<polygon") == 3);
    for (auto& channel : file.by_channel) channel.R.light.assign(20, 0);
    CHECK_THAT(profile_plot(file), !Contains("nan") && !Contains("inf"));
}

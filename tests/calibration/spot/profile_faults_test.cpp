// SPDX-License-Identifier: GPL-3.0-or-later
//
// Series that cannot be measured: each fault has its sentence.
#include <catch2/catch.hpp>

#include "base/error.h"
#include "spot_samples.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;

namespace {

// Of a measurement of the small camera's spot, changed.
std::string fault(const SpotCamera& camera, const ProfileMeasureOptions& options) {
    try {
        const PhotographedSide side = photographed(gaussian_side(camera.grid()), camera);
        (void)measure_merged(side.picture, side.series, options);
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

std::string fault(const SpotCamera& camera) { return fault(camera, options_for(camera)); }

std::string option_fault(void (*change)(ProfileMeasureOptions&)) {
    ProfileMeasureOptions options = options_for(small_camera());
    change(options);
    return fault(small_camera(), options);
}

std::string series_fault(const ExposureSeries& series) {
    try {
        (void)measure_side(series, options_for(small_camera()));
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

}  // namespace

TEST_CASE("Spots that cannot be measured are refused by name", "[slow]") {
    CHECK(fault(small_camera()) == "accepted");
    SpotCamera camera = small_camera();
    camera.stretch = 1.2;
    CHECK_THAT(fault(camera), Contains("reflection") && Contains("not round") && Contains("%"));
    camera = small_camera();
    camera.offset_px = {-48, 0};
    CHECK_THAT(fault(camera), Contains("from the border"));
    camera = small_camera();
    camera.peak = 4;
    CHECK_THAT(fault(camera), Contains("saturated in every exposure") && Contains("shorter"));
    camera = small_camera();
    camera.peak = 1e-6;
    CHECK_THAT(fault(camera), Contains("no light"));
}

TEST_CASE("Doubtful series are measured, and the doubt is said", "[slow]") {
    const auto warnings = [](const SpotCamera& camera) {
        const PhotographedSide side = photographed(gaussian_side(camera.grid()), camera);
        return measure_merged(side.picture, side.series, options_for(camera)).warnings;
    };
    CHECK(warnings(small_camera()).empty());
    SpotCamera camera = small_camera();
    camera.black = 0, camera.stray = 0;
    REQUIRE(warnings(camera).size() >= 1);
    CHECK_THAT(warnings(camera)[0], Contains("exactly 0") && Contains("black level") && Contains("[noisy-profile]"));
    camera = small_camera();
    camera.size_px = 64, camera.offset_px = {0, 0};
    REQUIRE(warnings(camera).size() >= 1);
    CHECK_THAT(warnings(camera)[0], Contains("last tenth") && Contains("beyond") && Contains("[cut-profile]"));
    camera = small_camera();
    camera.peak = 0.02, camera.read_noise = 0.02, camera.black = 0.1;
    REQUIRE(warnings(camera).size() >= 1);
    CHECK_THAT(warnings(camera)[0], Contains("light of all rings") && Contains("shorter reach"));
}

TEST_CASE("A time that is wrong is told from what the other exposures say", "[slow]") {
    const SpotCamera camera = small_camera();
    const SpotScene scene(gaussian_side(camera.grid()), camera);
    const auto measured = [&](double true_over_said) {
        ExposureMerge merge{CameraNoise{}};
        for (std::size_t k = 0; k < 3; ++k) {
            Exposure lit = scene.photograph(k, true), dark = scene.photograph(k, false);
            if (k == 2) lit.seconds /= true_over_said, dark.seconds /= true_over_said;
            merge.add(lit, dark);
        }
        return measure_merged(merge.merged(), {"transmission", {}, {}, {0.5, 0.6, 0.7}}, options_for(camera));
    };
    CHECK(measured(1).warnings.empty());
    CHECK(measured(1).step[1] == Approx(1).epsilon(0.002));
    const MeasuredSide dial = measured(32.0 / 30);
    REQUIRE(dial.warnings.size() >= 1);
    CHECK_THAT(dial.warnings[0], Contains("% brighter") && Contains("@SECONDS") && Contains("[exposures]"));
    CHECK_THROWS_WITH(measured(2), Contains("transmission") && Contains("brighter") && Contains("time is wrong"));
}

TEST_CASE("Options out of range and series that are not whole are refused by name", "[slow]") {
    CHECK_THAT(option_fault([](ProfileMeasureOptions& o) { o.mm_per_px = 0; }), Contains("mm per pixel is 0"));
    CHECK_THAT(option_fault([](ProfileMeasureOptions& o) { o.spacing_mm = 0.03; }),
               Contains("spacing is 0.03") && Contains("0.04 mm"));
    CHECK_THAT(option_fault([](ProfileMeasureOptions& o) { o.spacing_mm = -1; }), Contains("spacing is -1"));
    CHECK_THAT(option_fault([](ProfileMeasureOptions& o) { o.reach_mm = -1; }), Contains("reach is -1"));
    CHECK_THAT(option_fault([](ProfileMeasureOptions& o) { o.reach_mm = 5; }), Contains("5 mm does not fit"));
    CHECK_THAT(option_fault([](ProfileMeasureOptions& o) { o.most_asymmetry = 0; }), Contains("asymmetry is 0"));
    CHECK_THAT(option_fault([](ProfileMeasureOptions& o) { o.noise.full_well = 0; }), Contains("full well is 0"));
    CHECK_THAT(option_fault([](ProfileMeasureOptions& o) { o.noise.read_noise = 0; }), Contains("read noise is 0"));
    CHECK_THAT(option_fault([](ProfileMeasureOptions& o) { o.noise.saturation = 1.5; }), Contains("saturation is 1.5"));
    CHECK_THAT(series_fault({"reflection", {}, {}, {0.5, 0.5, 0.5}}),
               Contains("reflection") && Contains("no exposures"));
    CHECK_THAT(series_fault({"reflection", {{"a", 1}}, {}, {0.5, 0.5, 0.5}}), Contains("1 exposures and 0 dark"));
    CHECK_THAT(series_fault({"reflection", {{"a", 1}}, {{"b", 1}}, {0.5, 0, 0.5}}),
               Contains("green") && Contains("is 0"));
    CHECK_THAT(series_fault({"reflection", {{"a", 1}}, {{"b", 1}}, {0.5, 0.2, 1.5}}),
               Contains("blue") && Contains("1.5"));
}

TEST_CASE("A disc lowers coefficients from where its factor says") {
    // 2 J1(z) / z = 0.9 at z = 0.90811 (Abramowitz and Stegun, Table 9.1: J1(0.9) = 0.40595, so 0.9021 at 0.9).
    const double k = blurred_from(0.1, 0.1), z = 2 * 3.14159265358979 * k * 0.1;
    CHECK(2 * std::cyl_bessel_j(1, z) / z == Approx(0.9).epsilon(1e-9));
    CHECK(z == Approx(0.908).epsilon(0.005));
    CHECK(blurred_from(0.2, 0.1) == Approx(k / 2));
}

TEST_CASE("Albedos that make light are refused with channel and figures") {
    CHECK_NOTHROW(expect_no_light_made({0.9, 0.9, 0.9}, {0.1, 0.12, 0}));
    CHECK_THROWS_WITH(expect_no_light_made({0.9, 0.7, 0.5}, {0.1, 0.5, 0.5}),
                      Contains("green") && Contains("0.7") && Contains("1.2 in all"));
}

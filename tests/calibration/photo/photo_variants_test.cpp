// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rendered photographs of targets whose reflectances are known: every square within 0.005 of the truth, or a clear
// refusal where that is expected. Fixed seeds.
#include <algorithm>
#include <functional>
#include <optional>
#include <string>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/random.h"
#include "calibration/fit/resin_fit.h"
#include "optics/colour/observed_colour.h"
#include "photo_samples.h"

#ifdef __SANITIZE_ADDRESS__
// Nine tables of OpenCV's conversion to Lab, 4.7 MB, are there until the process ends. That nothing else of OpenCV's is
// kept is looked at where stacks are whole: in voxtone-calibrate.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:cv::fastMalloc\n"; }
#endif

using namespace voxtone;
using namespace voxtone::calibration;
using namespace voxtone::calibration::testing;

namespace {

constexpr double wanted = 0.005;

struct Rendered {
    Target target = target_of(TargetLayout::b);
    TargetColours truth = reflected_colours(target, changed_vero());
    CheckerChart chart = find_checker("colorchecker24");
};

const Rendered& rendered() {
    static const Rendered all;
    return all;
}

/// Inks that sRGB cannot say and a camera can, in the channels that a photograph measures them in.
optics::ResinSet saturated_inks(bool process) {
    optics::ResinSet set = optics::vero_opaque();
    set.name = "saturated";
    set.channels = optics::wide_channels();
    set.resins = {{"Cyan", "C", {9, 5, 8}, {0.89, 0.97, 0.988}},
                  {"Magenta", "M", {3, 4, 9}, {0.988, 0.8, 0.965}},
                  {"Yellow", "Y", {3, 4, 17}, {0.996, 0.993, 0.75}},
                  {"Black", "K", {5, 5.5, 6.5}, {0.35, 0.35, 0.35}},
                  {"White", "W", {6, 9, 24}, {0.9991, 0.9997, 0.999}}};
    if (process) return set;
    // Spot colours in their places.
    set.resins = {{"Green", "C", {7, 5, 9}, {0.93, 0.988, 0.95}},
                  {"Violet", "M", {5, 6, 9}, {0.95, 0.9, 0.988}},
                  {"Orange", "Y", {3, 5, 15}, {0.995, 0.96, 0.75}},
                  {"Brown", "K", {6, 7, 9}, {0.8, 0.6, 0.4}},
                  {"Ivory", "W", {7, 9, 20}, {0.9993, 0.9994, 0.997}}};
    return set;
}

/// A square is some 48 px wide: of the camera's usual noise, 0.8 % of a light pixel (20,000 electrons at 1), 0.03 % is
/// left in the mean of its inner 900, a seventeenth of `wanted`. Only edges need rays, and blur smooths these more.
PhotoOptions options_of(const std::function<void(PhotoOptions&)>& change, std::uint64_t seed) {
    PhotoOptions options;
    options.width_px = 900;
    options.height_px = 600;
    options.rays = 2;
    options.seed = seed;
    change(options);
    return options;
}

/// What blurs, hides or drowns more of a square than a small photograph has pixels for.
void larger(PhotoOptions& options) {
    options.width_px = 1440;
    options.height_px = 960;
}
void largest(PhotoOptions& options) {
    options.width_px = 1800;
    options.height_px = 1200;
}

/// Largest error of all squares and channels, in units of `wanted`.
double error_of(const PhotoOptions& options) {
    const Rendered& r = rendered();
    SimulatedPhoto photo = simulate_photo(r.target, r.truth, r.chart, options);
    const PhotoMeasurement m = measure_photo(std::move(photo.photograph), r.target, r.chart, {});
    return worst_error(m.rho, r.truth);
}

struct Variant {
    const char* name;
    std::function<void(PhotoOptions&)> change;
};

void check(const std::vector<Variant>& variants) {
    std::uint64_t seed = 100;
    for (const Variant& variant : variants) {
        INFO(variant.name);
        CHECK(error_of(options_of(variant.change, ++seed)) < wanted);
    }
}

using O = PhotoOptions;

}  // namespace

// Inks that are media in wide channels. Inks of smooth spectra are not, and are fitted better in sRGB cut at 0:
// benchmarks/calibration/target/rgb-against-spectral.
TEST_CASE("inks more saturated than sRGB are measured and fitted as well as others, in wide channels") {
    const Target target = target_of(TargetLayout::b);
    const CheckerChart chart = find_checker("colorchecker24");
    const auto measured = [&](const TargetColours& truth) {
        SimulatedPhoto photo = simulate_photo(target, truth, chart, options_of([](O&) {}, 7));
        std::vector<PhotoMeasurement> photos;
        photos.push_back(measure_photo(std::move(photo.photograph), target, chart, {}));
        CHECK(worst_error(photos[0].rho, truth) < wanted);
        return photos;
    };
    const auto least = [](const PatchTable& table) {
        double found = 1;
        for (const Patch& patch : table.patches) found = std::min(found, std::ranges::min(patch.rho));
        return found;
    };
    // Mean CIEDE2000 of all squares by the resins that are fitted to a table.
    const auto fitted_error = [&](const PatchTable& table, const TargetColours& truth) {
        FitOptions options;
        options.name = "fitted";
        const TargetColours found = reflected_colours(target, fit_resins(table, options).set);
        double sum = 0;
        for (std::size_t s = 0; s < truth.squares.size(); ++s)
            sum += optics::ciede2000(optics::lab_from_linear_srgb(found.squares[s]),
                                     optics::lab_from_linear_srgb(truth.squares[s]));
        return sum / double(truth.squares.size());
    };
    const TargetColours truth = reflected_colours(target, saturated_inks(GENERATE(true, false)));
    double most_negative = 0;
    for (const Eigen::Vector3d& rgb : truth.squares) most_negative = std::min(most_negative, rgb.minCoeff());
    REQUIRE(most_negative < -0.03);
    const auto photos = measured(truth);
    const MeasuredTable wide = average_photos(photos, target, PhotoChannels::wide);
    CHECK(wide.table.channels == optics::wide_channels());
    CHECK(least(wide.table) > 0);
    const optics::ObservedColour<double> observed(wide.table.channels);
    for (std::size_t s = 0; s < truth.squares.size(); ++s)
        CHECK((observed.absolute(wide.table.patches[s].rho.data()) - truth.squares[s]).cwiseAbs().maxCoeff() < wanted);
    CHECK_THAT(wide.warnings.back(), Catch::Contains("more saturated") && Catch::Contains("wide channels"));
    const MeasuredTable cut = average_photos(photos, target);
    CHECK(cut.table.channels.is_rgb());
    CHECK(least(cut.table) == 0);
    REQUIRE(cut.warnings.size() >= 2);
    CHECK_THAT(cut.warnings[cut.warnings.size() - 2], Catch::Contains("written as 0"));
    CHECK_THAT(cut.warnings.back(), Catch::Contains("written as 1"));
    // Others stay what they were.
    auto usual_photos = measured(rendered().truth);
    const MeasuredTable usual = average_photos(usual_photos, target);
    CHECK(usual.table.channels.is_rgb());

    const double of_wide = fitted_error(wide.table, truth), of_cut = fitted_error(cut.table, truth),
                 of_usual = fitted_error(usual.table, rendered().truth);
    INFO("CIEDE2000 of fitted squares: wide " << of_wide << ", cut to sRGB " << of_cut << ", usual inks " << of_usual);
    CHECK(of_wide < 1.5 * of_usual);
    CHECK(of_cut > 3 * of_wide);

    usual_photos[0].rho[0][1] = 1.03;
    const MeasuredTable light = average_photos(usual_photos, target);
    CHECK(light.table.patches[0].rho[1] == 1);
    CHECK_THAT(light.warnings.back(), Catch::Contains("up to 1.030, and is written as 1"));
    CHECK(usual.warnings.size() + 1 == light.warnings.size());
}

TEST_CASE("photographs from any side are measured within 0.005") {
    check({{"straight", [](O&) {}},
           {"tilted a little", [](O& o) { o.tilt_x_deg = 8, o.tilt_y_deg = -5; }},
           {"tilted forward", [](O& o) { o.tilt_x_deg = 25; }},
           {"tilted both ways and turned", [](O& o) { o.tilt_x_deg = 20, o.tilt_y_deg = -20, o.turn_deg = 30; }},
           {"on its side", [](O& o) { larger(o), o.turn_deg = 90; }},
           {"upside down", [](O& o) { o.turn_deg = 180; }},
           {"from near by", [](O& o) { o.distance = 1.4, o.tilt_x_deg = 12; }},
           {"chart turned the other way", [](O& o) { o.checker_turns = 3; }},
           {"chart lying flat", [](O& o) { o.checker_turns = 0; }}});
}

TEST_CASE("blurred and noisy photographs are measured within 0.005") {
    check({{"sharp", [](O& o) { o.blur_px = 0; }},
           {"blur of 1.5 px", [](O& o) { o.blur_px = 1.5; }},
           {"blur of 2.5 px", [](O& o) { larger(o), o.blur_px = 2.5; }},
           {"few electrons", [](O& o) { o.electrons = 3000; }},
           {"very few electrons, a bad amplifier", [](O& o) { largest(o), o.electrons = 800, o.read_noise = 2e-3; }},
           {"exposed at a quarter", [](O& o) { o.exposure = 0.25; }}});
}

TEST_CASE("photographs in uneven light are measured within 0.005") {
    check(
        {{"vignetting of 30 %", [](O& o) { o.vignetting = 0.3; }},
         {"vignetting of 60 %", [](O& o) { o.vignetting = 0.6; }},
         {"lamp at 0.6 m", [](O& o) { o.lamp_mm = 600; }},
         {"lamp at 0.4 m beside the chart", [](O& o) { o.lamp_mm = 400, o.lamp_azimuth_deg = 0; }},
         {"lamp at 0.4 m beside the target", [](O& o) { o.lamp_mm = 400, o.lamp_azimuth_deg = 180, o.exposure = 0.6; }},
         {"light from far away", [](O& o) { o.lamp_mm = 0, o.vignetting = 0; }}});
}

TEST_CASE("dirty targets and wrong white balance are measured within 0.005") {
    check({{"clean", [](O& o) { o.dust = 0, o.scratches = 0; }},
           {"300 specks of dust", [](O& o) { o.dust = 300; }},
           {"30 scratches", [](O& o) { larger(o), o.scratches = 30; }},
           {"red",
            [](O& o) {
                o.white_balance = {1, 0.5, 0.4};
            }},
           {"green",
            [](O& o) {
                o.white_balance = {0.35, 1, 0.5};
            }},
           {"a camera of pure channels", [](O& o) { o.matrix = 0; }},
           {"a camera that mixes more", [](O& o) { o.matrix = 1.2; }}});
}

TEST_CASE("everything at once is measured within 0.005") {
    constexpr int combinations = 8;
    for (std::uint64_t seed = 1; seed <= combinations; ++seed) {
        RandomStream random(2026, seed);
        const auto between = [&](double a, double b) { return a + (b - a) * random.uniform(); };
        const PhotoOptions options = options_of(
            [&](O& o) {
                larger(o);
                o.tilt_x_deg = between(-20, 20), o.tilt_y_deg = between(-20, 20), o.turn_deg = between(-180, 180);
                o.distance = between(1.8, 5), o.lamp_mm = between(500, 2000), o.lamp_azimuth_deg = between(0, 360);
                o.blur_px = between(0.3, 1.8), o.vignetting = between(0, 0.5), o.exposure = between(0.4, 0.95);
                o.white_balance = {between(0.4, 1), between(0.7, 1), between(0.4, 1)};
                o.electrons = between(2000, 40000), o.dust = int(between(0, 200)), o.scratches = int(between(0, 15));
                o.checker_turns = int(between(0, 4));
            },
            seed);
        INFO("combination " << seed << ": tilt " << options.tilt_x_deg << " " << options.tilt_y_deg << ", turn "
                            << options.turn_deg << ", lamp " << options.lamp_mm << ", blur " << options.blur_px
                            << ", vignetting " << options.vignetting << ", chart " << options.checker_turns);
        CHECK(error_of(options) < wanted);
    }
}

TEST_CASE("standard errors of photographs are honest with a checker that is one percent off") {
    // Errors of a photograph are common to its squares, so that each of the ten counts for little more than one value;
    // their mean squares of (error / standard error) lie between 0.3 and 3, the mean of ten within the bounds below.
    // Errors stated at half their size give 4 times as much, at twice their size a quarter: both fail.
    const Rendered& r = rendered();
    double square = 0;
    int count = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const PhotoOptions options = options_of([](O& o) { o.checker_error = 0.01; }, seed);
        const PhotoMeasurement m =
            measure_photo(simulate_photo(r.target, r.truth, r.chart, options).photograph, r.target, r.chart, {});
        for (std::size_t s = 0; s < m.rho.size(); ++s)
            square += (m.rho[s] - r.truth.squares[s]).cwiseQuotient(m.error[s]).squaredNorm();
        count += 3 * int(m.rho.size());
    }
    CAPTURE(square / count);
    // A checker's error is shared by all squares of a photograph: some 20 independent values in each, four of their
    // standard errors.
    CHECK(square / count == Approx(1).margin(4 * std::sqrt(2.0 / (10 * 20))));
}

TEST_CASE("dark squares whose noise is cut off at 0 are within errors that count it") {
    // An amplifier so bad that a fifth of black's pixels would lie below 0: what is left there is too light.
    const Rendered& r = rendered();
    PhotoOptions options = options_of(
        [](O& o) { o.exposure = 0.8, o.electrons = 1e9, o.read_noise = 0.0058, o.dust = o.scratches = 0; }, 5);
    options.vignetting = 0;
    const PhotoMeasurement m =
        measure_photo(simulate_photo(r.target, r.truth, r.chart, options).photograph, r.target, r.chart, {});
    double worst = 0, without = 0;
    int dark = 0;
    for (std::size_t s = 0; s < m.rho.size(); ++s)
        for (int c = 0; c < 3; ++c) {
            const AreaSample& sample = m.squares[s];
            if (sample.at_zero[c] < 0.1) continue;
            const double excess = m.model.to_linear_srgb().row(c).cwiseAbs().dot(sample.zero_excess) /
                                  m.model.light(sample.middle_px),
                         off = m.rho[s][c] - r.truth.squares[s][c];
            worst = std::max(worst, off / m.error[s][c]);
            without = std::max(without, off / std::sqrt(std::pow(m.error[s][c], 2) - excess * excess));
            ++dark;
        }
    CAPTURE(dark, worst, without);
    CHECK(dark >= 3);
    CHECK(worst < 1.5);
    CHECK(without > 2);  // so far off they would be by the errors of noise, light and colours alone
}

TEST_CASE("photographs as bad as they come are measured within 0.005 or refused") {
    // Which are refused is not laid down: blur, clipping, darkness, dirt and steep light each may do it. What must not
    // be is a value that is off and said to be good: beyond 0.005 only what its own standard error covers four times.
    // There is a limit to that, beyond the dirt drawn here: see docs/calibrate.md. Of 24 draws the five that are
    // measured (7 comes to 0.97 of what it may be off), and of those refused one for each reason, the nearest to its
    // border.
    int measured = 0, refused = 0;
    for (const std::uint64_t seed : {1, 6, 7, 12, 19, 3, 5, 9, 11, 13, 17}) {
        RandomStream random(1789, seed);
        const auto between = [&](double a, double b) { return a + (b - a) * random.uniform(); };
        const PhotoOptions options = options_of(
            [&](O& o) {
                largest(o);
                o.rays = 3;  // scratches of a third of a pixel
                o.tilt_x_deg = between(-45, 45), o.tilt_y_deg = between(-45, 45), o.turn_deg = between(-180, 180);
                o.distance = between(1.2, 6), o.lamp_mm = between(300, 1000), o.lamp_azimuth_deg = between(0, 360);
                o.blur_px = between(0, 4), o.vignetting = between(0, 0.7),
                o.exposure = std::pow(10, between(-1.2, 0.1));
                o.electrons = std::pow(10, between(2.5, 4.5)), o.read_noise = between(0, 3e-3);
                o.dust = int(between(0, 400)), o.scratches = int(between(0, 30)), o.checker_turns = int(between(0, 4));
            },
            seed);
        INFO("photograph " << seed << ": tilt " << options.tilt_x_deg << " " << options.tilt_y_deg << ", lamp "
                           << options.lamp_mm << ", blur " << options.blur_px << ", vignetting " << options.vignetting
                           << ", exposure " << options.exposure << ", electrons " << options.electrons << ", dust "
                           << options.dust << ", scratches " << options.scratches);
        const Rendered& r = rendered();
        std::optional<PhotoMeasurement> m;
        try {
            m = measure_photo(simulate_photo(r.target, r.truth, r.chart, options).photograph, r.target, r.chart, {});
        } catch (const InputError&) {
            ++refused;
            continue;
        }
        ++measured;
        double worst = 0;
        for (std::size_t s = 0; s < m->rho.size(); ++s) {
            const Eigen::Vector3d off = (m->rho[s] - r.truth.squares[s]).cwiseAbs(),
                                  said = (4 * m->error[s]).cwiseMax(wanted);
            worst = std::max(worst, off.cwiseQuotient(said).maxCoeff());
        }
        CHECK(worst < 1);
    }
    CAPTURE(measured, refused);
    CHECK(measured >= 3);
    CHECK(refused >= 3);
}

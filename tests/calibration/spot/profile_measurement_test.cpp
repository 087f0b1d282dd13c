// SPDX-License-Identifier: GPL-3.0-or-later
//
// The profile that was photographed comes back: slabs are simulated, photographed with noise and measured.
#include "calibration/spot/profile_measurement.h"

#include <cmath>
#include <map>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/Dense>
#include <catch2/catch.hpp>

#include "spot_samples.h"

using namespace voxtone;
using namespace voxtone::calibration;

namespace {

// Traced once for all tests.
const SlabProfiles& slab(const std::string& role, double thickness_mm, const SpotCamera& camera) {
    static std::map<std::string, SlabProfiles> made;
    SlabProfiles& profiles = made[fmt::format("{} {}", role, thickness_mm)];
    if (profiles.R[0].empty())
        profiles = slab_profiles(optics::vero_opaque(), role, thickness_mm, camera.grid(), 1 << 17, 1);
    return profiles;
}

// The straight lines between even samples that are nearest to the truth over the plane, with `total` under them.
std::vector<double> straight_lines(const SpotScene& scene, std::size_t channel, double spacing_mm, std::size_t samples,
                                   double total) {
    constexpr int parts = 40;  // midpoints within a spacing
    const auto n = static_cast<Eigen::Index>(samples);
    Eigen::MatrixXd N = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(n), areas = Eigen::VectorXd::Zero(n);
    for (Eigen::Index i = 0; i + 1 < n; ++i)
        for (int part = 0; part < parts; ++part) {
            const double t = (part + 0.5) / parts, r = (static_cast<double>(i) + t) * spacing_mm;
            const double area = 2 * std::numbers::pi * r * spacing_mm / parts, f = scene.light(channel, r);
            const Eigen::Vector2d tents(1 - t, t);
            N.block<2, 2>(i, i) += area * tents * tents.transpose();
            b.segment<2>(i) += area * f * tents;
            areas.segment<2>(i) += area * tents;
        }
    Eigen::VectorXd a = N.ldlt().solve(b);
    a *= total / areas.dot(a);
    return {a.begin(), a.end()};
}

// Differences from the truth in stated errors.
struct Coverage {
    double within_1 = 0, within_2 = 0, chi2 = 0, samples = 0;

    void add(const MeasuredSide& measured, const SpotScene& scene) {
        for (std::size_t c = 0; c < 3; ++c) {
            const RadialProfile& p = measured.profile[c];
            const auto truth = straight_lines(scene, c, measured.spacing_mm, p.light.size(), measured.total[c]);
            for (std::size_t i = 0; i < truth.size(); ++i) {
                const double z = (p.light[i] - truth[i]) / p.error[i];
                within_1 += std::abs(z) < 1, within_2 += std::abs(z) < 2, chi2 += z * z, samples += 1;
            }
        }
    }
    // Four standard errors of shares and of the mean square of normal numbers; neighbours are related by about -0.3,
    // which widens the last by a fifth.
    [[nodiscard]] bool normal() const {
        const double share_1 = 0.6827, share_2 = 0.9545;
        return std::abs(within_1 / samples - share_1) < 4 * std::sqrt(share_1 * (1 - share_1) / samples) &&
               std::abs(within_2 / samples - share_2) < 4 * std::sqrt(share_2 * (1 - share_2) / samples) &&
               std::abs(chi2 / samples - 1) < 4 * 1.2 * std::sqrt(2 / samples);
    }
    [[nodiscard]] std::string text() const {
        return fmt::format("{:.4f} within one error, {:.4f} within two, mean square {:.3f}, {} samples",
                           within_1 / samples, within_2 / samples, chi2 / samples, samples);
    }
};

MeasuredSide measure(const PhotographedSide& side, const SpotCamera& camera) {
    return measure_merged(side.picture, side.series, options_for(camera));
}

}  // namespace

TEST_CASE("The profiles of white at 3 mm and black at 0.75 mm come back within their errors") {
    Coverage all, wrong;
    std::uint64_t seed = 10;
    for (const auto& [role, thickness_mm] : {std::pair<std::string, double>{"W", 3}, {"K", 0.75}})
        for (const bool reflected : {true, false}) {
            SpotCamera camera;
            camera.seed = ++seed;
            const SlabProfiles& truth = slab(role, thickness_mm, camera);
            const PhotographedSide side = photographed(reflected ? truth.R : truth.T, camera);
            const MeasuredSide measured = measure(side, camera);
            all.add(measured, side.scene);
            INFO(role << (reflected ? " reflected" : " transmitted"));
            CHECK((measured.centre.px - side.scene.centre_px()).norm() < 0.01);
            CHECK(measured.warnings.empty());
            for (std::size_t c = 0; c < 3; ++c) {
                CHECK(measured.profile[c].asymmetry < 0.01);
                CHECK(measured.profile[c].light.size() > 170);  // 7.8 mm
                // The exact total, as users of profiles sum it up.
                optics::RadialSamples samples = measured.samples(c);
                const double total = *samples.total;
                samples.total.reset();
                CHECK(optics::HankelGrid(8, 4).from_even(samples.light, samples.spacing_mm)[0] ==
                      Approx(total).epsilon(1e-10));
            }
            // The wrong sibling: a scale that is off by a percent.
            ProfileMeasureOptions off = options_for(camera);
            off.mm_per_px *= 0.99;
            wrong.add(measure_merged(side.picture, side.series, off), side.scene);
        }
    INFO(all.text());
    CHECK(all.normal());
    INFO(wrong.text());
    CHECK_FALSE(wrong.normal());
}

TEST_CASE("Errors hold for noisy cameras, spots elsewhere, stray light, coarse samples and a noise that is not known") {
    const auto check = [](const char* name, void (*change)(SpotCamera&), double assumed_noise) {
        SpotCamera camera;
        camera.size_px = 200, camera.seed = 21;
        change(camera);
        const SlabProfiles truth = slab_profiles(optics::vero_opaque(), "K", 0.75, camera.grid(), 1 << 14, 1);
        const PhotographedSide side = photographed(truth.R, camera, assumed_noise);
        const MeasuredSide measured = measure(side, camera);
        CHECK((measured.centre.px - side.scene.centre_px()).norm() < 0.02);
        CHECK(measured.profile[0].noise == Approx(1 / assumed_noise).epsilon(0.08));  // steps of 12 bits add 6 %
        Coverage coverage;
        coverage.add(measured, side.scene);
        INFO(name << ": " << coverage.text());
        CHECK(coverage.normal());
    };
    check(
        "noisy", [](SpotCamera& c) { c.full_well = 3000, c.read_noise = 2e-3; }, 1);
    check(
        "shifted",
        [](SpotCamera& c) {
            c.offset_px = {-31.37, 24.81};
        },
        1);
    check(
        "stray light",
        [](SpotCamera& c) {
            c.stray = 1e-3, c.seconds = {0.1, 0.4, 1.6, 6.4};
        },
        1);
    check(
        "12 bits", [](SpotCamera& c) { c.bits = 12; }, 1);
    check(
        "noise said to be half", [](SpotCamera&) {}, 0.5);
}

TEST_CASE("A layer of measured profiles is the layer that was photographed, through spot, blur and pixel") {
    for (const auto& [role, thickness_mm] : {std::pair<std::string, double>{"W", 3}, {"K", 0.75}}) {
        SpotCamera camera;
        camera.seed = 31;
        const SlabProfiles& truth = slab(role, thickness_mm, camera);
        const PhotographedSide R = photographed(truth.R, camera), T = photographed(truth.T, camera);
        const MeasuredSide measured_R = measure(R, camera), measured_T = measure(T, camera);
        const optics::HankelGrid grid(camera.grid().reach_mm(), 24);  // its coefficients are the first of the camera's
        for (std::size_t c = 0; c < 3; ++c) {
            optics::MeasuredSummary summary;
            const optics::LayerProfile layer =
                optics::measured_layer({thickness_mm, measured_T.samples(c), measured_R.samples(c)}, grid, summary)
                    .of_thickness(thickness_mm);
            // What lies beyond the last sample is counted within: up to its share of the light.
            const auto beyond = [&](const SpotScene& scene) {
                double within = 0;
                const double reach = camera.mm_per_px * 190, step = 1e-3;
                for (double r = step / 2; r < reach; r += step)
                    within += 2 * std::numbers::pi * r * step * scene.light(c, r);
                return std::abs(*scene.truth(c, 1, 1).total - within);
            };
            const double lost_R = beyond(R.scene), lost_T = beyond(T.scene);
            CHECK(layer.R_top[0] == Approx(truth.R[c][0]).epsilon(1e-9));
            CHECK(layer.T[0] == Approx(truth.T[c][0]).epsilon(1e-9));
            for (std::size_t i = 1; i < grid.size(); ++i) {
                const double k = grid.k()[i], z = 2 * std::numbers::pi * k;
                const double variance = camera.blur_mm * camera.blur_mm + camera.mm_per_px * camera.mm_per_px / 12;
                const double disc = 2 * std::cyl_bessel_j(1, z * camera.spot_mm) / (z * camera.spot_mm);
                const double seen = disc * std::exp(-z * z * variance / 2);
                INFO(role << " channel " << c << " k " << k);
                CHECK(std::abs(layer.R_top[i] - seen * truth.R[c][i]) < 2 * lost_R + 1e-3 * truth.R[c][0]);
                CHECK(std::abs(layer.T[i] - seen * std::max(0.0, truth.T[c][i])) < 2 * lost_T + 1e-3 * truth.T[c][0]);
                CHECK(std::abs(layer.R_top[i] - truth.R[c][i]) <
                      0.05 * truth.R[c][0]);  // and of the layer itself, below 0.8 / mm
            }
        }
    }
}

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The profile that was photographed comes back: slabs are simulated, photographed with noise and measured.
#include "voxtone/calibration/profile_measurement.h"

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
    if (profiles.R[0].empty()) profiles = slab_profiles(optics::vero_opaque(), role, thickness_mm, camera.grid(), 1 << 17, 1);
    return profiles;
}

// The straight lines between even samples that are nearest to the truth over the plane, with `total` under them.
std::vector<double> straight_lines(const SpotScene& scene, std::size_t channel, double spacing_mm, std::size_t samples, double total) {
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
};

}  // namespace

TEST_CASE("debug") {
    Coverage all;
    for (const auto& [role, mm] : {std::pair<std::string, double>{"W", 3.0}, {"K", 0.75}})
        for (int t = 0; t < 2; ++t)
        for (std::uint64_t seed = 1; seed < 6; ++seed) {
            SpotCamera camera;
            camera.seed = seed + (t ? 100 : 0) + (role == "W" ? 1000 : 0);
            const auto& s = slab(role, mm, camera);
            const auto side = photographed(t ? s.T : s.R, camera);
            const MeasuredSide m = measure_merged(side.picture, side.series, options_for(camera));
            Coverage one;
            one.add(m, side.scene), all.add(m, side.scene);
            const Eigen::Vector2d off = (m.centre.px - side.scene.centre_px()).cwiseQuotient(m.centre.error_px);
            fmt::print("{} {} centre {:.2f} {:.2f} noise {:.3f} in1 {:.3f} in2 {:.3f} chi2 {:.3f}\n", role, t ? "T" : "R", off.x(), off.y(), m.profile[1].noise, one.within_1 / one.samples, one.within_2 / one.samples, one.chi2 / one.samples);
        }
    fmt::print("all in1 {:.3f} in2 {:.3f} chi2 {:.3f} n {}\n", all.within_1 / all.samples, all.within_2 / all.samples, all.chi2 / all.samples, all.samples);
    // layer
    for (const auto& [role, mm] : {std::pair<std::string, double>{"W", 3.0}, {"K", 0.75}}) {
        SpotCamera camera;
        const auto& s = slab(role, mm, camera);
        const auto R = photographed(s.R, camera), T = photographed(s.T, camera);
        const MeasuredSide mR = measure_merged(R.picture, R.series, options_for(camera)), mT = measure_merged(T.picture, T.series, options_for(camera));
        const optics::HankelGrid fine = camera.grid();
        const optics::HankelGrid grid(fine.reach_mm(), 24);
        for (std::size_t c = 0; c < 3; ++c) {
            optics::MeasuredSummary sum;
            const auto layer = optics::measured_layer({mm, mT.samples(c), mR.samples(c)}, grid, sum);
            fmt::print("{} c{} neg {:.4f} {:.4f} beyond {:.4f} {:.4f} clamped {:.4f} \n", role, c, sum.negative_T, sum.negative_R, sum.beyond_T, sum.beyond_R, sum.clamped);
            const auto l = layer.of_thickness(mm);
            for (std::size_t i = 0; i < 24; i += 3) {
                const double k = grid.k()[i], z = 2 * std::numbers::pi * k * camera.spot_mm;
                const double seen = std::exp(-2 * std::numbers::pi * std::numbers::pi * k * k * (camera.blur_mm * camera.blur_mm + camera.mm_per_px * camera.mm_per_px / 12)) * (z > 0 ? 2 * std::cyl_bessel_j(1, z) / z : 1);
                fmt::print("  k {:.3f} R {:.5f} truth {:.5f} seen {:.5f}  T {:.6f} truth {:.6f} seen {:.6f}\n", k, l.R_top[i], s.R[c][i], s.R[c][i] * seen, l.T[i], s.T[c][i], s.T[c][i] * seen);
            }
        }
    }
}

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

#include "voxtone/base/error.h"
#include "voxtone/calibration/profile_simulation.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;

namespace {

struct Side {
    SpotScene scene;
    MergedPicture picture;
    ExposureSeries series;
};

// Traced once for all tests.
const SlabProfiles& slab(const std::string& role, double thickness_mm, const optics::HankelGrid& grid) {
    static std::map<std::string, SlabProfiles> made;
    const std::string key = fmt::format("{} {} {} {}", role, thickness_mm, grid.reach_mm(), grid.size());
    if (!made.count(key)) made[key] = slab_profiles(optics::vero_opaque(), role, thickness_mm, grid, 1 << 17, 1);
    return made[key];
}

Side photographed(const std::array<std::vector<double>, 3>& side, const SpotCamera& camera, const CameraNoise& noise = {}) {
    Side result{SpotScene(side, camera), {}, {"reflection", {}, {}, {side[0][0], side[1][0], side[2][0]}}};
    ExposureMerge merge(noise);
    for (std::size_t k = 0; k < camera.seconds.size(); ++k)
        merge.add(result.scene.photograph(k, true), result.scene.photograph(k, false));
    result.picture = merge.merged();
    return result;
}

ProfileMeasureOptions options_for(const SpotCamera& camera) {
    ProfileMeasureOptions options;
    options.mm_per_px = camera.mm_per_px;
    options.noise.full_well = camera.full_well;
    options.noise.read_noise = camera.read_noise;
    return options;
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

}  // namespace

TEST_CASE("debug seeds") {
    for (int seed = 1; seed <= 16; ++seed)
        for (int t = 0; t < 1; ++t) {
            SpotCamera camera;
            camera.seed = seed;
            const auto& s = slab("K", 0.75, camera.grid());
            const Side side = photographed(t ? s.T : s.R, camera);
            const MeasuredSide m = measure_merged(side.picture, side.series, options_for(camera));
            const double h = m.spacing_mm;
            for (std::size_t c = 0; c < 3; ++c) {
                const auto& p = m.profile[c];
                const auto truth = straight_lines(side.scene, c, m.spacing_mm, p.light.size(), m.total[c]);
                double near = 0, mid = 0, far = 0, mean = 0, lag=0, last=0;
                for (std::size_t i = 0; i < p.light.size(); ++i) {
                    const double z = (p.light[i] - truth[i]) / p.error[i], r = static_cast<double>(i) * h;
                    (r < 0.5 ? near : r < 2 ? mid : far) += z * z;
                    if (r > 2) mean += z, lag += z * last;
                    last = z;
                }
                const double n = static_cast<double>(p.light.size());
                fmt::print("seed {} {} c{} near {:.2f} mid {:.2f} far {:.2f} mean far {:.2f} lag {:.2f}\n", seed, t ? "T" : "R", c, near / 12, mid / 34, far / (n - 46), mean / (n - 46), lag/(n-46));
            }
        }
}

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The profile that was photographed comes back: slabs are simulated, photographed with noise and measured.
#include "voxtone/calibration/profile_measurement.h"

#include <cmath>
#include <map>
#include <numbers>

#include <catch2/catch.hpp>
#include <fmt/format.h>

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

}  // namespace

TEST_CASE("debug figures") {
    for (const auto& [role, mm] : {std::pair<std::string, double>{"W", 3.0}, {"K", 0.75}})
        for (int t = 0; t < 2; ++t) {
            SpotCamera camera;
            const auto& s = slab(role, mm, camera.grid());
            const Side side = photographed(t ? s.T : s.R, camera);
            const MeasuredSide m = measure_merged(side.picture, side.series, options_for(camera));
            fmt::print("{} {} centre off {:.5f} {:.5f} err {:.5f} {:.5f} steps {}\n", role, t ? "T" : "R", m.centre.px.x() - side.scene.centre_px().x(),
                       m.centre.px.y() - side.scene.centre_px().y(), m.centre.error_px.x(), m.centre.error_px.y(), m.centre.steps);
            for (auto& w : m.warnings) fmt::print("  {}\n", w);
            for (std::size_t c = 0; c < 3; ++c) {
                const auto& p = m.profile[c];
                int in1 = 0, in2 = 0;
                double chi = 0;
                fmt::print(" c{} noise {:.3f} asym {:.4f} scale err {:.4f} miss {} total {:.4f}\n", c, p.noise, p.asymmetry, p.scale_error, p.missing, m.total[c]);
                const auto truth = side.scene.truth(c, m.spacing_mm, p.light.size());
                for (std::size_t i = 0; i < p.light.size(); ++i) {
                    const double z = (p.light[i] - truth.light[i]) / p.error[i];
                    in1 += std::abs(z) < 1, in2 += std::abs(z) < 2, chi += z * z;
                    if (c == 1 && (i < 12 || i % 20 == 0)) fmt::print("   r {:.3f} f {:.5g} truth {:.5g} err {:.3g} z {:.2f}\n", static_cast<double>(i) * m.spacing_mm, p.light[i], truth.light[i], p.error[i], z);
                }
                const double n = static_cast<double>(p.light.size());
                fmt::print("   in1 {:.3f} in2 {:.3f} chi2 {:.3f}\n", in1 / n, in2 / n, chi / n);
            }
        }
}

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lit points to photograph and measure.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "calibration/rehearsal/profile_simulation.h"
#include "calibration/spot/profile_measurement.h"

namespace voxtone::calibration {

using SideCoefficients = std::array<std::vector<double>, 3>;

/// Light that spreads as Gaussians, wider from channel to channel.
inline SideCoefficients gaussian_side(const optics::HankelGrid& grid) {
    SideCoefficients side;
    for (std::size_t c = 0; c < 3; ++c)
        for (const double k : grid.k()) {
            const double z = 2 * std::numbers::pi * k * (0.3 + 0.1 * static_cast<double>(c));
            side[c].push_back((0.5 + 0.1 * static_cast<double>(c)) * std::exp(-z * z / 2));
        }
    return side;
}

/// A small, quick camera.
inline SpotCamera small_camera() {
    SpotCamera camera;
    camera.size_px = 120;
    camera.seconds = {0.1, 0.4, 1.6};
    return camera;
}

struct PhotographedSide {
    SpotScene scene;
    MergedPicture picture;
    ExposureSeries series;
};

/// `assumed` times the camera's noise is what the merge is told.
inline PhotographedSide photographed(const SideCoefficients& side, const SpotCamera& camera, double assumed = 1) {
    PhotographedSide result{SpotScene(side, camera), {}, {"reflection", {}, {}, {side[0][0], side[1][0], side[2][0]}}};
    ExposureMerge merge(
        {camera.full_well / (assumed * assumed), camera.read_noise * assumed, CameraNoise{}.saturation});
    for (std::size_t k = 0; k < camera.seconds.size(); ++k)
        merge.add(result.scene.photograph(k, true), result.scene.photograph(k, false));
    result.picture = merge.merged();
    return result;
}

inline ProfileMeasureOptions options_for(const SpotCamera& camera) {
    ProfileMeasureOptions options;
    options.mm_per_px = camera.mm_per_px;
    options.noise.full_well = camera.full_well, options.noise.read_noise = camera.read_noise;
    return options;
}

}  // namespace voxtone::calibration

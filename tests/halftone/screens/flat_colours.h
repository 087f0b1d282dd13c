// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far flat halftoned colours, printed as `slice` would, are from what was asked for: targets in gamut are separated
// by Eq. 7 and by the medium of voxels, screened, and the voxels judged by Monte Carlo (CIEDE2000, media-relative).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "optics/media/resins.h"

namespace voxtone {

struct FlatCase {
    std::string name;
    optics::ResinSet set;  ///< with a white, W: the core, 3 mm on a black sheet
    std::array<double, 3> pitch_mm;
    double shell_mm = 1;
    int targets = 24;
    bool from_mixtures = false;  ///< targets are colours of random mixtures; else even in sRGB, as far as in gamut
    bool blue_noise = true;      ///< else error diffusion
};

/// One target by one separation.
struct FlatColour {
    Eigen::Vector3d rgb;             ///< asked for, linear
    double difference = 0;           ///< of what is seen from that
    double lookup = 0;               ///< of what the separation's own model says: the error of its lattice
    double noise = 0;                ///< estimate of what the noise of Monte Carlo alone makes
    Eigen::Vector3d lab_difference;  ///< seen less asked for
};

struct FlatColours {
    std::vector<FlatColour> eq7, voxels;
};

/// The cases of the benchmark: Vero on three printers and two depths, with clear, other resins.
[[nodiscard]] std::vector<FlatCase> flat_cases();

/// `paths`: of Monte Carlo per colour and channel.
[[nodiscard]] FlatColours measure_flat_colours(const FlatCase& the, std::uint32_t paths);

}  // namespace voxtone

// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much of each resin a print will take, before its layers are made.
//
// The volume is counted: the voxels of up to 400 layers, one from each of as many stretches of equal height, all of
// them where there are no more. Which resins they are is sampled: about 25,000 voxels spread evenly over the volume
// are asked for their nearest surface point and for the mixture that is wanted there, as the layers will be
// (layers/block_mixtures.h), and the mixtures are added up unscreened.
//
// Error, standard deviation: of the volume below 1 % where the cross-section of a layer's height says little about its
// neighbours', 0.1 % for usual bodies; of a resin that fills the share f of the print less than sqrt(f / 25,000) of
// the whole. Layers and voxels are drawn by addressed random numbers: the same for any number of threads.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/progress.h"
#include "slicer/options/option_values.h"
#include "slicer/part/job_body.h"

namespace voxtone::slicer {

/// Fractions of the resins, to be added to `sum` with `weight`, wanted `depth_mm` below a point of a triangle of the
/// textured mesh. Called from several threads.
using MixtureBelow = std::function<void(std::uint32_t source_triangle, const Eigen::Vector2f& uv, double depth_mm,
                                        double weight, std::span<double> sum)>;

struct VolumeQuery {
    LayerRange layers{};
    bool keep_thin = true;
    double shell_mm = 0;     ///< what lies deeper is core; 0: all is
    std::size_t resins = 1;  ///< of the print
    std::size_t core = 0;    ///< index of the core's resin
    MixtureBelow mixture;    ///< of the shell; may be empty where there is none
};

struct ResinVolumes {
    double body_ml = 0;
    double shell_ml = 0;     ///< of the voxels whose resin is a matter of colour
    std::vector<double> ml;  ///< by resin; they sum to body_ml
};

/// Throws Cancelled.
[[nodiscard]] ResinVolumes resin_volumes(const JobBody& body, const VolumeQuery& query, const Progress& progress);

}  // namespace voxtone::slicer

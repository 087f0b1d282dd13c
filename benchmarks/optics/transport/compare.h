// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a prediction differs by from its reference.
//
// Colours are media-relative: each model's appearance divided by its own appearance of the same body all of white resin
// at the same place, read as linear sRGB. The white of the reference is exact (layered_appearance.h) for slabs with
// mirrored sides; else traced. The white of the predictor is predicted.
//
// With P the predictor's colour of a cell, M1 and M2 those of the two halves of the reference and M their mean, and
// means over cells weighted by their area of surface:
//   mean, 95 %, max      of dE(P, M), CIEDE2000, the noise of M included
//   noise                mean of dE(M1, M2) / 2: what M's noise alone would make of the mean
//   rms                  sqrt of the mean of dE(P, M)^2 - dE(M1, M2)^2 / 4. With |.| the metric of CIEDE2000 at M this
//                        is the mean of <P - M1, P - M2>, the product of the two differences: unbiased and free of
//                        noise, as M1 and M2 are independent. The mean error without noise is not larger.
//   mean without noise   mean * rms / (rms with noise): right where error and noise are distributed alike, too large
//                        where the error sits in few cells
//   bias                 mean of L*(P) - L*(M)
// The 95th percentile and the maximum are reported with the noise in them.
// Negative appearances (the predictor's, in the dark) count as 0.
#pragma once

#include "optics/transport/transport.h"
#include "reference_file.h"

namespace voxtone::accuracy {

using Rgb = std::array<float, 3>;

struct Comparison {
    double mean = 0, percentile_95 = 0, max = 0, bias = 0;
    double noise = 0, rms = 0, mean_without_noise = 0;
    std::array<double, 3> channel_bias{};  ///< mean of P - M
    /// Of the mean of the white, as a share of it: what media-relative colour hides.
    std::array<double, 3> white_bias{};
    std::size_t cells = 0;          ///< of the surface
    std::size_t optical_cells = 0;  ///< of transport
    double area_mm2 = 0;
    double core_seconds = 0;  ///< of one prediction; its white is not counted
    /// Core seconds in which Monte Carlo, tracing every cell, has the same rms error, by those of the predictor. Where
    /// the rms is lost in the noise of the reference a tenth of that noise stands for it.
    double times_faster = 0;
    std::vector<Rgb> predicted, reference;  ///< media-relative, per cell
    std::vector<float> error;               ///< dE(P, M) per cell
    optics::Surface surface;
};

/// `refine`: into how many parts every voxel is cut along x, y and z before the prediction. Same body, finer cells:
/// what then remains of an error is not the cells'.
[[nodiscard]] Comparison compare(const Reference& reference, const optics::TransportOptions& options,
                                 const std::array<int, 3>& refine = {1, 1, 1});

/// The appearance of a slab with mirrored sides, all of this resin, per channel: exact.
[[nodiscard]] std::vector<double> exact_slab(const optics::ResinSet& set, std::size_t resin, double thickness_mm,
                                             optics::Backing backing);

/// The value below which `share` of the weight lies.
[[nodiscard]] double weighted_percentile(std::span<const double> values, std::span<const double> weights, double share);

}  // namespace voxtone::accuracy

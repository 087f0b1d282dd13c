// SPDX-License-Identifier: GPL-3.0-or-later
//
// How what a slab sends back moves with each of its resins: for prints whose resins are to be told from photographs.
//
//   d value / d ln sigma_t    (albedo as it is),    d value / d ln (sigma_a / sigma_s)    (sigma_t as it is)
//
// by channel, which light does not leave, of the print as it is: layers, edges and what lies deeper count. A prediction
// by the fast model on viewing cells for each resin and each of the two, a step of a tenth aside; less the one without
// a step. What curves is a twentieth of it. Resins that the print has not stay 0.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "slicer/options/option_values.h"
#include "slicer/predict/predicted_stack.h"

namespace voxtone::slicer {

/// Means over blocks of cells; rows from the largest y, as pixels of a picture.
struct ResinResponse {
    static constexpr int block = 4;  ///< cells along each side
    int columns = 0, rows = 0;       ///< of blocks
    std::size_t channels = 0, resins = 0;
    std::vector<float> value;          ///< of a perfect diffuser's: [block * channels + channel]
    std::vector<float> by_extinction;  ///< [(block * resins + resin) * channels + channel]
    std::vector<float> by_absorption;  ///< the same; empty where it was not asked for
};

/// What is asked for: extinctions alone take half as long.
enum class ResinParts { extinction, extinction_and_absorption };

/// `seen`: from above, on the same backing.
[[nodiscard]] ResinResponse resin_response(const PredictedStack& seen, const PredictFigures& figures, ResinParts parts,
                                           Progress& progress);

/// The same print by light paths, cell by cell of `seen`, in linear sRGB of a perfect diffuser's: as many
/// paths a channel as its regions want, eight million at most, noise and all. Other paths than those of any seed of
/// `predict`.
[[nodiscard]] std::vector<Eigen::Vector3f> colours_by_paths(const PredictedStack& seen, const PredictFigures& figures,
                                                            Progress& progress);

}  // namespace voxtone::slicer

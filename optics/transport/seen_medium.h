// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a viewing cell that holds voxels of several resins is to light, and its derivatives.
//
// Where in a cell a resin lies is seen: light falls off as exp(-kappa s) on its way in and out, kappa^2 = 3 sigma_a
// (sigma_a + (1 - g) sigma_s) of the cell's mean. So the layers of a cell across the way to the nearest surface are
// weighed by
//
//   w_l = exp(-1.6 kappa l h),   f_r = sum_l s_rl w_l / sum_rl s_rl w_l,   medium = (sum_rl s_rl) H(f),
//
// s_rl the share of the cell's volume that resin r has in layer l, h the thickness of a layer, H the medium of the
// halftone (effective_medium.h); sigma and kappa in mm^-1, h in mm. It takes a quarter off the error of photographs
// (docs/decisions/007).
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>

#include "optics/media/effective_medium.h"
#include "optics/transport/channel_media.h"

namespace voxtone::optics {

struct SeenMedium {
    const EffectiveMedium& halftone;
    const ResinSet& resins;
    std::array<double, 3> pitch_mm{};

    [[nodiscard]] Medium operator()(const Mixture& mixture, std::size_t channel) const;
    /// out[layer * resins + resin] = d (sigma_a, sigma_s) / d s_rl, the weights w taken as fixed. A cell of one resin,
    /// whose layers the mixture does not tell apart, has its resin in `layers` equal ones along `axis`; a cell of more
    /// has those of the mixture.
    void derivatives(const Mixture& mixture, std::size_t channel, std::size_t axis, std::size_t layers,
                     std::span<std::array<double, 2>> out) const;

private:
    /// Weight of layer l is exp(-fall * l).
    [[nodiscard]] double fall(const Medium& mean, std::size_t axis) const;
};

/// The media of a grid that was filled (homogenisation.h): seen media of its cells and parts, with the albedo that
/// makes half-spaces exact (transport_medium.h), and what its core is to diffusion.
[[nodiscard]] GridMedia media_of_grid(const ViewingGrid& grid, const EffectiveMedium& halftone, const ResinSet& resins,
                                      std::size_t channel);

/// Of its cells, as media_of_grid has them.
[[nodiscard]] std::shared_ptr<const TransportMedia> media_of_cells(const ViewingGrid& grid);

}  // namespace voxtone::optics

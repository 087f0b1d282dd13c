// SPDX-License-Identifier: GPL-3.0-or-later
//
// Derivative of a function F of the appearance with respect to the resins of a viewing grid.
//
// L psi = S psi with psi coming in through the surface; the adjoint of L is L with all directions reversed. With psi*
// the light that enters through each face with radiance d F / d (flux that leaves there), in a cell of volume V (mm^3;
// sigma in mm^-1; adjoints: Lewis and Miller 1984, Ch. 1)
//
//   d F / d sigma_t = -V sum_d w_d psi_d psi*_-d,   d F / d sigma_s = V (phi phi* - 3 g' J . J*).
//
// The sum over directions is taken of psi = phi + 3 Omega . J, where it is phi phi* - 3 J . J*: it costs nothing, and
// the kept moments are enough. In cells at the surface, where light of some directions comes in and of others is
// mirrored, the product of what the light on the faces has beyond phi and J is added, faded on its way to the cell's
// middle.
//
// Against the sum itself (slab and sphere of 2 mm, colours in 0.5 mm): cosine over all voxels and resins 0.994 and
// 0.987, scale 0.98 and 0.94; of changes that keep the sum of the fractions 0.999 and 0.997, scale 1.00 and 1.02.
// Without the faces 0.957 and 0.966, 0.93 and 0.91.
//
// From there to a voxel: transport media (transport_medium.h) by differences, the cell's medium by seen_medium.h, and
// the voxel's share of the cell's volume.
//
// What it leaves out: how the weights of a cell's layers and the g'' of its medium (transport_medium.h) depend on its
// resins; bubbles smaller than a cell, that are seen as the cell's phi; resins of core blocks. It is of cells of the
// eye alone: sequences refine nothing. It is the derivative of the converged light: a loop sweeps its adjoint twice and
// has a cosine of 0.9995 (slab) and 0.994 (sphere) with differences of converged predictions, scale 0.96 and 0.98;
// after eight sweeps 0.9998 and 0.996, 0.97 and 0.97 (viewing_gradient_test, "at a loop's effort").
//
// Memory: 4 bytes a cell and channel (upper halves of floats: 8 bits, 0.4 %, are plenty), and a table by mixture,
// layer, resin.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "optics/grid/viewing_grid.h"
#include "optics/scene/appearance_model.h"
#include "optics/transport/seen_medium.h"
#include "optics/transport/transport_medium.h"

namespace voxtone::optics {

class ViewingGradient final : public ResinGradient {
public:
    /// `grid` must outlive it and keep its resins.
    ViewingGradient(const ViewingGrid& grid, const SeenMedium& seen, std::size_t channels);
    /// A channel's share, from the derivatives by the TransportMedium of each cell.
    void add(std::size_t channel, const TransportMedia& media_of, const SeenMedium& seen,
             std::span<const float> by_sigma_t, std::span<const float> by_sigma_s);
    [[nodiscard]] float at(const std::array<int, 3>& voxel, std::size_t resin) const override;
    void all_at(const std::array<int, 3>& voxel, std::span<float> out) const override;
    [[nodiscard]] std::size_t memory_bytes() const;

private:
    [[nodiscard]] std::size_t row(std::size_t mixture, const ViewingGrid::Home& home) const;
    void take(const std::array<int, 3>& voxel, std::size_t first_resin, std::span<float> out) const;
    void add_from(const ViewingGrid::Home& home, std::size_t first_resin, float weight, std::span<float> out) const;

    const ViewingGrid& grid_;
    std::size_t resins_ = 0, channels_ = 0;
    std::array<int, 2> spread_step_{};
    std::vector<std::array<std::uint16_t, 2>> by_medium_;  ///< [cell * channels + channel]: by sigma_t, sigma_s
    /// Of each mixture: a row for each of its layers; of one resin `alone`, for those along each axis.
    std::vector<std::uint32_t> first_row_;
    /// [(row * resins + resin) * channels + channel]: d (sigma_t, sigma_s) / d share.
    std::vector<std::array<float, 2>> table_;
};

}  // namespace voxtone::optics

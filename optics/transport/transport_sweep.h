// SPDX-License-Identifier: GPL-3.0-or-later
//
// One discrete-ordinates sweep of half the directions through the transport cells of an optical grid.
//
// In each cell, for each of the octant's 8 directions (one vector register):
//   psi = (fit q + sum_a 2 |Omega_a| / h_a psi_in,a) / (fit sigma_t + sum_a 2 |Omega_a| / h_a),
//   psi_out,a = 2 psi - psi_in,a,     q = sigma_s (phi + 3 g'' Omega . J),
// diamond differences (Lewis and Miller 1984, Ch. 4) with fit = 2 tanh(sigma_a l / 2) / (sigma_a l), l the mean way of
// the direction through the cell: a cell that only absorbs lets exp(-sigma_a l) through, where diamond differences
// alone let (2 - sigma_a l) / (2 + sigma_a l) (exponential fitting, as Doolan, Miller and Schilders 1980, "Uniform
// numerical methods for problems with initial and boundary layers", do it for other equations). What the cell itself
// sees is the balance fit psi + (1 - fit) q / sigma_t. Where light is scattered and not absorbed fit is 1, and diamond
// differences keep the diffusion limit in thick cells. Between coarse and fine cells the radiance of a face is averaged
// or repeated.
//
// That is a cell of a wide medium. Into a small one amid others light comes evenly over its sides, and some of it cuts
// a corner: the mean over the cell of what is absorbed on its way is m = <exp(-sigma_a s)> (mean_in_box) for (1 -
// exp(-sigma_a l)) / (sigma_a l), which is less. A part of one resin (refinement.h) has the one by the share of its
// faces behind which others lie, the other for the rest, and fit = 2 m / (2 - sigma_a l m). Yellow voxels of a halftone
// take up less blue then: the suite's mean is 0.41 for 0.46, and 0.27 for 0.35 as an eye at 300 mm sees it; edges and
// gratings of solids stay, lines and dots move by 0.02 at most (`predictor_accuracy --fine 1 compare`).
//
// Diamond differences answer an edge in the light that comes in with ripples from cell to cell. With a weight theta
// below 1,
//   psi_out,a = (1 + theta) psi - theta psi_in,a,   (1 + theta) |Omega_a| / h_a for 2 |Omega_a| / h_a,
// and fit = (1 + theta) (1 - e) / ((theta + e) sigma_a l), e = exp(-sigma_a l), ripples die out, at the price of some
// blur where light is not diffuse; where it is, the medium's g'' for g' takes back what they widen
// (transport_medium.h). These are weighted differences; Rhoades and Engle 1977, "A new weighted-difference formulation
// for discrete ordinates calculations", Trans. Am. Nucl. Soc., choose the weight cell by cell from the fluxes, here it
// is one number, so that the equations stay linear.
//
// psi, phi, J of light 1 that comes in from everywhere; h in mm, sigma in mm^-1; fit in (0, 1], with
// theta = 0.85 up to 1.005.
//
// Work: cells x 8 directions, about 30 vector instructions a cell; data touched: 16 bytes of moments in and out per
// cell and 3 bytes of geometry. The order of arithmetic is fixed, and what is fused is so everywhere: the same bits on
// every run and instruction set.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/progress.h"
#include "optics/grid/viewing_grid.h"
#include "optics/transport/sweep_rows.h"
#include "optics/transport/transport_medium.h"

namespace voxtone::optics {

/// phi and J of a cell.
struct alignas(16) Moments {
    float phi = 0, x = 0, y = 0, z = 0;
    Moments& operator+=(const Moments& more) {
        phi += more.phi;
        x += more.x;
        y += more.y;
        z += more.z;
        return *this;
    }
    friend Moments operator+(Moments a, const Moments& b) { return a += b; }
    friend Moments operator*(float share, const Moments& m) {
        return {share * m.phi, share * m.x, share * m.y, share * m.z};
    }
};

/// What a medium does to light on its way through a cell, the same in all octants: gain and rest in mm. With
/// d = 1 + theta and sigma = fit sigma_t:
///   gain = d / (sigma + sum d |Omega| / h);
/// d psi averaged over the cell is fit (d psi) + rest q fit.
struct alignas(64) SweepMedium {
    Octet gain, fit, rest;
    float sigma_s = 0, linear = 0;
};

/// For cells of these edges; `theta`: weight of the differences. Two calls of libm a direction and medium: to be made
/// once a channel.
[[nodiscard]] std::vector<SweepMedium> sweep_media(const DirectionSet& set, const std::array<double, 3>& edge_mm,
                                                   float theta, std::span<const TransportMedium> media);

/// The cells of one kind of blocks: whole ones, or the parts of those that are cut finer (FineBlocks).
struct SweepCells {
    std::span<const SweepMedium> media;  ///< by what the grid says that they hold, of this channel and `theta`
    std::span<const Moments> light;      ///< phi and J of what is scattered
    std::span<Moments> sum;              ///< becomes phi and J of the half's light
    float theta = 1;                     ///< weight of the differences
};

struct SweepJob {
    const ViewingGrid& grid;
    SweepCells cells, parts;    ///< no parts: their blocks are swept as whole cells
    std::span<const Octet> in;  ///< [open face * 4 + tangential signs]: radiance that enters
    std::span<Octet> out;       ///< the same, that leaves
    /// Per face into the core phi and net current outwards: psi = phi - 3 |Omega . e| J comes in.
    std::span<const std::array<float, 2>> core_in;
    std::span<float> core_out;           ///< [core face * 4 + tangential signs]: sum w |Omega . e| psi that leaves
    const SweepRows& rows;               ///< of this half; crossed at once where they have several fronts
    const Progress* progress = nullptr;  ///< asked for cancellation before every row of blocks
};

/// The four octants of light that runs up, or down. Octant bits: 1, 2, 4 set where light runs against x, y, z. Throws
/// Cancelled.
void sweep_half(const SweepJob& job, bool down);

/// Place among the four octants that cross a face perpendicular to `axis` one way.
[[nodiscard]] constexpr int tangential_signs(int octant, int axis) {
    switch (axis) {
        case 0:
            return octant >> 1;
        case 1:
            return (octant & 1) | (octant >> 1 & 2);
        default:
            return octant & 3;
    }
}

}  // namespace voxtone::optics

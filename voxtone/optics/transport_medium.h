// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a medium is to the transport predictor: the albedo with which its few directions give the exact half-space.
//
// Eight streams along z and the linear phase function make a homogeneous half-space a little too dark, by at most 0.002,
// an amount that depends on the albedo alone (diamond differences of cells of any depth have the same half-space). Here
// the same discrete equations are solved for the half-space (one cell by a linear system, then doubling), and the albedo
// alpha* is found with which they give the appearance that the exact solution (layered_appearance.h) has at alpha.
// alpha* = 1 at alpha = 1. With the interpolated alpha* a half-space is exact within 1e-4 (tested).
#pragma once

#include <array>
#include <vector>

#include "voxtone/optics/resins.h"
#include "voxtone/optics/transport_directions.h"

namespace voxtone::optics {

/// Coefficients of the discrete equations in one channel, mm^-1.
struct TransportMedium {
    float sigma_t = 0;  ///< without the forward peak
    float sigma_s = 0;  ///< without the forward peak
};

class TransportMedia {
public:
    explicit TransportMedia(const DirectionSet& set);

    [[nodiscard]] TransportMedium operator()(const Medium& medium) const;
    /// The same in double precision: sigma_t, sigma_s.
    [[nodiscard]] std::array<double, 2> exact(const Medium& medium) const;
    /// 1 - alpha* for this albedo.
    [[nodiscard]] double loss(double albedo) const;
    /// Appearance of a half-space by the discrete equations, in cells of this optical depth.
    [[nodiscard]] double discrete_half_space(double albedo, double depth = 0.1) const;

private:
    DirectionSet set_;
    std::vector<double> ratio_;  ///< (1 - alpha*) / (1 - alpha) at the nodes of alpha
};

}  // namespace voxtone::optics

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Layered light transport of waves: light that varies as exp(2 pi i k x) along a layer, in all directions.
//
// The transport equation keeps such a wave apart from every other; with phi the azimuth against x it reads
//
//   mu dI/dz = -(sigma_t + 2 pi i k sin(theta) cos(phi)) I + sigma_s / 4 pi  integral p I
//
// I is known at the directions of an angular grid (angular_grid.h) and as a series of `orders` terms i^m cos(m phi) in
// azimuth. Scattering keeps orders apart (the addition theorem of Legendre's functions), the way sideways joins
// neighbours: with i^m in front all is real. Layers are then matrices R and T of directions x orders, doubled and added
// as in adding_doubling.h. At k = 0 orders do not meet: what is left is that file's equations. Spread light that is
// radially symmetric at the entry has these as its Hankel coefficients (optics/numerics/hankel.h).
//
// What passes without being scattered is known in closed form, Bessel functions of 2 pi k t tan(theta): layers that
// hardly scatter are made so, means over the band of each direction, since few directions alone would never wash out.
//
// Range: as adding_doubling.h; k >= 0. Error with 4 + 4 directions and 6 orders: totals 1e-4; coefficients of 0.3 mm of
// white up to 1 per mm 2e-4, up to 6 per mm 0.003 of R and 0.005 of T (wave_ordinates_test.cpp). Time: (directions x
// orders)^3, some 25 times a layer.
#pragma once

#include <Eigen/Core>

#include "optics/layered/angular_grid.h"
#include "optics/media/resins.h"

namespace voxtone::optics {

/// Of a homogeneous layer, the same from both sides: radiances out of radiances in.
struct LayerWaves {
    Eigen::MatrixXd R, T;
};

class WaveOrdinates {
public:
    /// Contract: every weight of the grid positive, orders >= 1.
    WaveOrdinates(AngularGrid grid, double g, int orders);

    [[nodiscard]] int size() const { return grid_.size() * orders_; }
    [[nodiscard]] const AngularGrid& grid() const { return grid_; }

    /// A homogeneous layer for waves of k per mm.
    [[nodiscard]] LayerWaves layer(const Medium& medium, double thickness_mm, double k_per_mm) const;
    /// The same of twice the thickness.
    [[nodiscard]] static LayerWaves doubled(const LayerWaves& half);
    /// Whether a layer is taken in closed form: doubling such ones would bring back what few directions get wrong.
    [[nodiscard]] static bool is_unscattering(const Medium& medium, double thickness_mm);

    /// Values by direction, the same all around: light of order 0.
    [[nodiscard]] Eigen::VectorXd all_around(const Eigen::ArrayXd& by_direction) const;
    /// What a smooth surface sends back of light from within, by direction and order.
    [[nodiscard]] Eigen::VectorXd mirrored(const Eigen::ArrayXd& reflectance) const;

private:
    [[nodiscard]] LayerWaves unscattered(const Medium& medium, double thickness_mm, double k_per_mm) const;

    AngularGrid grid_;
    int orders_;
    double truncated_;                 ///< share of scattering that counts as none (phase.h)
    Eigen::MatrixXd same_, opposite_;  ///< scattering, times the weights of directions
    Eigen::MatrixXd sideways_;         ///< sin(theta) cos(phi)
    Eigen::VectorXd inverse_nu_;       ///< by direction and order
};

/// What lies below a level: what it sends up of what comes down, and what leaves below it for good.
struct WavesBelow {
    Eigen::MatrixXd R;
    Eigen::RowVectorXd leaving;

    /// With a layer above it.
    [[nodiscard]] WavesBelow under(const LayerWaves& layer) const;
};

}  // namespace voxtone::optics

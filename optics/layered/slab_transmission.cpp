// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/slab_transmission.h"

#include <algorithm>

#include "optics/numerics/dense.h"

namespace voxtone::optics {

double slab_transmission(const OrdinatePlan& plan, const Medium& medium, double thickness_mm, LightThrough light) {
    constexpr double clear_per_mm = 1e-9;  // what has less is as clear as air
    const AngularGrid& grid = plan.grid();
    const Admittance top = LayerModes(plan, {medium.sigma_a, std::max(medium.sigma_s, clear_per_mm)})
                               .over(Admittance::air(plan, true), thickness_mm);
    // Nothing comes from above: (Y_surface + Y) U = -p, and x- = U / (1 + r) is what goes up to the upper face.
    OrdinateMatrix sum = top.Y;
    sum.diagonal().array() += (1 - grid.r) / (1 + grid.r);
    const OrdinateMatrix source = -top.p;
    const Eigen::ArrayXd upward = cholesky_solved(sum, source).col(0).array() / (1 + grid.r), sqrt_c = grid.c.sqrt();
    const double eta2 = grid.eta * grid.eta;
    if (light == LightThrough::beam) {
        const int k = grid.find(1);
        return grid.t[k] * upward[k] / (sqrt_c[k] * eta2);
    }
    return (sqrt_c * grid.t * upward).sum() / (eta2 * (grid.t > 0).select(grid.c, 0).sum());
}

SlabTransmission slab_transmission_slopes(const OrdinatePlan& plan, const Medium& medium, double thickness_mm,
                                          LightThrough light) {
    const auto at = [&](const Medium& m) { return slab_transmission(plan, m, thickness_mm, light); };
    SlabTransmission result{at(medium), {}};
    const double step = 1e-4 * std::max(medium.sigma_t(), 1e-3);
    const auto slope = [&](double Medium::*value) {
        Medium below = medium, above = medium;
        below.*value = std::max(medium.*value - step, 0.0), above.*value += step;
        return (at(above) - at(below)) / (above.*value - below.*value);
    };
    result.by = {slope(&Medium::sigma_a), slope(&Medium::sigma_s)};
    return result;
}

}  // namespace voxtone::optics

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Radial profiles as discrete Hankel coefficients, so that spreading twice (2-D convolution) is a product.
//
//   f^(k) = 2 pi integral of f(r) J0(2 pi k r) r dr        (Hasan et al. 2010, Sec. 5.1; k in cycles per mm)
//
// taken at k_i = j_i / (2 pi reach), where j_0 = 0 and j_i is the i-th zero of J1. These are the waves that a disc of
// radius `reach` with a mirror as its rim can hold (Dini's series; Watson, A Treatise on the Theory of Bessel
// Functions, 2nd ed., Sec. 18.3):
//
//   f(r) = 1 / (pi reach^2)  sum_i f^(k_i) J0(2 pi k_i r) / J0(j_i)^2
//
// The usual transform, GSL's too, takes the zeros of J0: a disc whose rim swallows light, without a coefficient at k =
// 0. Here the first coefficient is the total, and it stays the total through any product.
//
// Coefficients are those of the profile on the endless plane, so products are exact at every k_i whatever the reach.
// Only the way back knows the disc: light beyond the rim is found folded inwards there, and what is finer than reach /
// n is smoothed, with the ripples of a series that ends (profiles that rise like 1/r at r = 0 have no value there: ask
// for light in rings). Time: n^3 once, n^2 a transform.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace voxtone::optics {

class HankelGrid {
public:
    /// n >= 2 coefficients; reach > 0.
    HankelGrid(double reach_mm, std::size_t n);

    [[nodiscard]] std::size_t size() const { return k_.size(); }
    [[nodiscard]] double reach_mm() const { return reach_mm_; }
    /// k_i, mm^-1, ascending; the first is 0.
    [[nodiscard]] std::span<const double> k() const { return k_; }
    /// n radii in (0, reach), mm: where the wave that follows the last has its zeros. Samples there and coefficients
    /// say the same.
    [[nodiscard]] std::span<const double> radii() const { return radii_; }

    /// From samples at `radii`: the coefficients whose series goes through them. The other half of the transform; the
    /// tree has its profiles as rings or as waves, so that only tests ask for it.
    [[nodiscard]] std::vector<double> from_radii(std::span<const double> f) const;
    /// From samples at 0, spacing, 2 spacing, ... mm, straight lines between them and nothing beyond the last: the
    /// exact integral of that (to 1e-12). May go beyond the reach. Contract: at least two samples.
    [[nodiscard]] std::vector<double> from_even(std::span<const double> f, double spacing_mm) const;
    /// From the light in rings, spread evenly over each: `edges_mm` ascending from >= 0, one more than rings. Exact.
    [[nodiscard]] std::vector<double> from_rings(std::span<const double> edges_mm, std::span<const double> light) const;

    /// Seen through a Gaussian blur of standard deviation s on each axis. From s = 1.5 reach / n on the end of the
    /// series leaves no ripples: below 2e-5 of the peak. What to draw, or to read a faint tail from.
    [[nodiscard]] std::vector<double> blurred(std::span<const double> coefficients, double s_mm) const;

    /// f(r), mm^-2, 0 <= r <= reach.
    [[nodiscard]] double profile(std::span<const double> coefficients, double r_mm) const;
    /// The light within r, 0 <= r <= reach. All of it, the first coefficient, at the rim.
    [[nodiscard]] double light_within(std::span<const double> coefficients, double r_mm) const;

private:
    double reach_mm_;
    std::vector<double> k_, radii_;
    std::vector<double> norm_;     ///< 1 / (pi reach^2 J0(j_i)^2)
    std::vector<double> inverse_;  ///< n x n, row i: coefficient i from the samples at `radii`
};

}  // namespace voxtone::optics

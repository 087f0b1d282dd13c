// SPDX-License-Identifier: GPL-3.0-or-later
//
// Large steps of light paths through one homogeneous medium: from an even scattering to a sphere around it, in one
// draw.
//
// A path that is scattered evenly in all directions at the middle of a sphere leaves it anywhere with equal chance, in
// a direction that is symmetric about the sphere's normal. What is left to know is the weight that it keeps, W =
// E[albedo^n], and how mu, the cosine of that direction to the normal, is distributed, weighed by the weight. The next
// free path starts there (a free path has no memory). Walks on spheres: M. E. Muller, "Some continuous Monte Carlo
// methods for the Dirichlet problem", Ann. Math. Statist. 27, 1956; in transport: J. A. Fleck, E. H. Canfield, "A
// random walk procedure ...", J. Comput. Phys. 54, 1984. Theirs takes diffusion for what happens within; here it is
// transport, with the true phase function.
//
// Henyey and Greenstein's function is even with probability (1 - |g|) / (1 + |g|)^2, its least value, and something
// else else; which of both a drawn cosine c came from chance decides by even_share / (2 p(c)), exactly.
//
// mu is tabulated by paths. W follows from it: psi = sum over l of (2 l + 1) phi_l i_l(k r) P_l(mu), the average over
// all directions s of the discrete mode exp(k s.x) sum of (2 l + 1) phi_l P_l(s.d), obeys the equation of transport, so
// that its mean does not change on the way: 1 = psi(0) = W E[psi(r, mu)]. Without absorption W = 1 exactly; else the
// error of a table's mean cosine, 0.3 / sqrt(paths), changes 1 - W by that times 2 / (radius sigma_t (1 - albedo g)).
// For albedos >= least_albedo.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "optics/media/resins.h"
#include "optics/monte_carlo/path_random.h"

namespace voxtone::optics {

class FirstPassage {
public:
    static constexpr std::size_t intervals = 64;
    static constexpr double least_albedo = 0.9;
    /// Smaller spheres are as fast walked through.
    static constexpr double least_optical_radius = 6;

    /// Radii in mm, rising. Spheres below the least optical radius have no table.
    FirstPassage(const Medium& medium, double g, std::span<const double> radii_mm);

    /// Number of the smallest sphere that has a table.
    [[nodiscard]] std::size_t first() const { return first_; }
    [[nodiscard]] double weight(std::size_t sphere) const { return spheres_[sphere].weight; }
    /// Equal shares of the light leave between two neighbours, rising.
    [[nodiscard]] const std::array<float, intervals + 1>& cosines(std::size_t sphere) const {
        return spheres_[sphere].cosines;
    }

private:
    struct Sphere {
        double radius = 0, weight = 1;
        std::array<float, intervals + 1> cosines{};
    };
    struct Exit {
        double cosine = 0, weight = 1;
    };
    [[nodiscard]] Exit trace(std::size_t sphere, PathRandom& random) const;
    [[nodiscard]] double pass(double clear_mm, std::size_t below, std::array<double, 3>& at, std::array<double, 3>& d,
                              PathRandom& random) const;
    void tabulate(std::size_t sphere);

    Medium medium_;
    double g_;
    std::size_t first_ = 0;
    std::vector<Sphere> spheres_;
};

/// Probability that Henyey and Greenstein's function scatters evenly.
[[nodiscard]] double even_share(double g);

}  // namespace voxtone::optics

// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/wave_ordinates.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

#include "optics/layered/adding_doubling.h"

using namespace voxtone::optics;

namespace {

// Diffuse light on a layer without surfaces: what comes back, what comes through.
struct Both {
    double R, T;
};
Both diffuse(const WaveOrdinates& waves, const LayerWaves& layer) {
    const Eigen::VectorXd in = waves.all_around(Eigen::ArrayXd::Ones(waves.grid().size())),
                          out = waves.all_around(waves.grid().c);
    return {out.dot(layer.R * in), out.dot(layer.T * in)};
}

}  // namespace

TEST_CASE("A wave that is none is light of adding-doubling") {
    const AngularGrid grid = angular_grid(1, 4, 4);
    const AddingDoubling doubling(angular_grid(1, 16, 16), 0.4, 48);
    for (const Medium& of : {Medium{0.01, 9}, Medium{3, 2}, Medium{0, 5}}) {
        const WaveOrdinates waves(grid, 0.4, 4);
        const Both found = diffuse(waves, waves.layer(of, 0.3, 0));
        const LayerResponse exact = doubling.layer(of, 0.3);
        const Eigen::VectorXd c = doubling.grid().c.matrix();
        CHECK(found.R == Approx(c.dot(exact.R_above * c)).margin(1e-4));
        CHECK(found.T == Approx(c.dot(exact.D_down * c) + c.dot(exact.direct.matrix())).margin(1e-4));
        if (of.sigma_a == 0) CHECK(found.R + found.T == Approx(1).margin(1e-6));
    }
}

TEST_CASE("Few directions and orders come near to many, for waves of a mm and of a sixth") {
    const Medium white{0.0027, 9};
    const WaveOrdinates few(angular_grid(1, 4, 4), 0.4, 6), many(angular_grid(1, 8, 8), 0.4, 12);
    for (const double k : {0.5, 1.0, 3.0, 6.0}) {
        const Both a = diffuse(few, few.layer(white, 0.3, k)), b = diffuse(many, many.layer(white, 0.3, k));
        INFO(k);
        CHECK(a.R == Approx(b.R).margin(k < 2 ? 2e-4 : 3e-3));
        CHECK(a.T == Approx(b.T).margin(k < 2 ? 2e-4 : 6e-3));
    }
    // Orders are needed: light that runs sideways goes on sideways.
    const WaveOrdinates flat(angular_grid(1, 8, 8), 0.4, 1);
    CHECK(std::abs(diffuse(flat, flat.layer(white, 0.3, 1)).R - diffuse(many, many.layer(white, 0.3, 1)).R) > 0.02);
}

TEST_CASE("Through a clear layer a wave is washed out as straight ways wash it") {
    // Diffuse light over a clear layer of t mm lands within r with 1 / (1 + t^2 / r^2): its transform is x K1(x) of
    // x = 2 pi k t.
    const WaveOrdinates waves(angular_grid(1, 4, 4), 0.4, 4);
    for (const double x : {0.2, 1.0, 3.0, 8.0, 40.0}) {
        const double k = x / (2 * std::numbers::pi * 0.7);
        const Both through = diffuse(waves, waves.layer({0, 0}, 0.7, k));
        CHECK(through.T == Approx(x * std::cyl_bessel_k(1, x)).margin(0.01));
        CHECK(through.R == 0);
    }
    // Two of half the thickness: what arrives in all orders goes on from there.
    const WaveOrdinates finer(angular_grid(1, 12, 12), 0.4, 16);
    const LayerWaves half = finer.layer({0.1, 0}, 0.2, 0.8), whole = finer.layer({0.1, 0}, 0.4, 0.8);
    CHECK(diffuse(finer, {half.R, half.T * half.T}).T == Approx(diffuse(finer, whole).T).margin(0.005));
}

TEST_CASE("Thin layers that absorb alone are the same in closed form and by doubling") {
    const WaveOrdinates waves(angular_grid(1, 8, 8), 0.4, 10);
    const Both closed = diffuse(waves, waves.layer({2, 0}, 0.2, 0.5)),
               doubled = diffuse(waves, waves.layer({2, 1e-3}, 0.2, 0.5));
    CHECK(closed.T == Approx(doubled.T).margin(1e-3));
}

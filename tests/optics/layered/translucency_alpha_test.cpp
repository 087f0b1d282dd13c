// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/translucency_alpha.h"

#include <catch2/catch.hpp>

#include <cmath>

#include "base/random.h"
#include "optics/layered/adding_doubling.h"
#include "optics/layered/directional.h"

using namespace voxtone;
using namespace voxtone::optics;

TEST_CASE("Translucency alpha of a grey is the standard's, there and back") {
    // Worked out by hand from A = (1 - exp(-0.0153 eta))^0.6.
    CHECK(translucency_alpha(0) == 0);
    CHECK(translucency_alpha(10) == Approx(0.3099).margin(1e-4));
    CHECK(translucency_alpha(50) == Approx(0.6868).margin(1e-4));
    CHECK(translucency_alpha(300) == Approx(0.9939).margin(1e-4));
    for (const double alpha : {0.01, 0.2, 0.5, 0.9, 0.999})
        CHECK(translucency_alpha(translucency_eta_per_cm(alpha)) == Approx(alpha).epsilon(1e-12));
    CHECK(std::isinf(translucency_eta_per_cm(1)));
}

TEST_CASE("Readings of grey slabs, by adding-doubling, tell the alpha that their material has") {
    const TranslucencyScale scale(1.5);
    const AngularGrid grid = angular_grid(1.5, 8, 8);
    const AddingDoubling solver(grid, 0, 32);
    RandomStream random(62, 1);
    double worst = 0;
    for (int i = 0; i < 60; ++i) {
        // 1/mm; from water to more than Vero white, from white to dark.
        const double s = 0.02 * std::pow(400, random.uniform()), a = s * 1e-4 * std::pow(1e4, random.uniform());
        CAPTURE(a, s);
        const LayerResponse slab = solver.layer({a, s}, translucency_slab_mm);
        const double on_white = appearance_of(grid, slab, Backing::white),
                     through = appearance_of(grid, slab, Backing::none) - appearance_of(grid, slab, Backing::black);
        if (through < 1e-9) continue;  // what no instrument tells from nothing
        const double found = translucency_alpha(scale.eta_per_cm({on_white, through}));
        const double off = std::abs(found - translucency_alpha(10 * (0.4 * a + s)));
        worst = std::max(worst, off);
        CHECK(off < 0.01);
    }
    CAPTURE(worst);
    CHECK(worst > 0);
}

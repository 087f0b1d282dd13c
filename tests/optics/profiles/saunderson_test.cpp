// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/profiles/saunderson.h"

#include <catch2/catch.hpp>

#include "optics/profiles/resin_profile.h"

using namespace voxtone::optics;

TEST_CASE("What a surface shows is the surface as a layer upon it, and back again") {
    const double s = internal_diffuse_reflectance(1.5);
    CHECK(s == Approx(0.596).margin(0.0005));  // diffuse internal reflection at n = 1.5 (Duntley 1942)
    CHECK(internal_diffuse_reflectance(1) == Approx(0).margin(1e-12));
    for (const double R : {0.0, 0.05, 0.4, 0.9, 1.0}) {
        const LayerProfile upon = laminate(smooth_surface(1.5, 1), {{0.0}, {R}, {0.0}});
        CHECK(seen_through_surface(R, s) == Approx(upon.R_top[0]).margin(1e-12));
        CHECK(behind_surface(seen_through_surface(R, s), s) == Approx(R).margin(1e-12));
    }
    CHECK(behind_surface(-0.01, s) == Approx(-0.01 / (1 - s)));  // noise stays as large as beside 0
    CHECK(behind_surface(0.3, 0) == 0.3);
}

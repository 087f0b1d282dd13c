// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/slab_transmission.h"

#include <cmath>

#include <catch2/catch.hpp>

#include "optics/layered/layered_appearance.h"

using namespace voxtone::optics;

namespace {

const OrdinatePlan& plan() {
    static const OrdinatePlan made = directional_plan(0.4, 1.5);
    return made;
}

double through(double sigma_t, double albedo, double mm, LightThrough light) {
    return slab_transmission(plan(), {sigma_t * (1 - albedo), sigma_t * albedo}, mm, light);
}

}  // namespace

TEST_CASE("what only absorbs lets a beam through by Fresnel and Beer, and what does nothing all that enters") {
    const double r = 0.04;
    for (const double depth : {1e-6, 0.1, 0.5, 3.0})
        CHECK(through(depth, 0, 1, LightThrough::beam) ==
              Approx((1 - r) * (1 - r) * std::exp(-depth) / (1 - r * r * std::exp(-2 * depth))).epsilon(1e-5));
    CHECK(slab_transmission(plan(), {}, 2, LightThrough::beam) == Approx((1 - r) / (1 + r)).epsilon(1e-5));
}

TEST_CASE("slabs let through what adding-doubling on arrays of another's has") {
    // benchmarks/calibration/target/layered_judge.py, 20 + 20 directions; six digits.
    struct Known {
        double sigma_t, albedo, mm, beam, diffuse;
    };
    for (const Known& k : {Known{0.5, 0, 1, 0.559308, 0.476109}, Known{4, 0.9, 0.2, 0.622180, 0.541881},
                           Known{12, 0.998, 0.5, 0.372416, 0.341088}, Known{12, 0.998, 2, 0.104544, 0.095804},
                           Known{8, 0.3, 0.1, 0.450664, 0.371326}}) {
        CAPTURE(k.sigma_t, k.mm);
        CHECK(through(k.sigma_t, k.albedo, k.mm, LightThrough::beam) == Approx(k.beam).epsilon(5e-5));
        CHECK(through(k.sigma_t, k.albedo, k.mm, LightThrough::diffuse) == Approx(k.diffuse).epsilon(5e-5));
    }
}

TEST_CASE("slopes of what comes through are those of wider differences, at the end of the scale too") {
    for (const Medium& m : {Medium{0.02, 12}, Medium{3, 1}, Medium{0, 5}})
        for (const LightThrough light : {LightThrough::diffuse, LightThrough::beam}) {
            const SlabTransmission at = slab_transmission_slopes(plan(), m, 0.5, light);
            CHECK(at.value == slab_transmission(plan(), m, 0.5, light));
            const double h = 1e-3;
            const auto of = [&](double a, double s) {
                return slab_transmission(plan(), {m.sigma_a + a, m.sigma_s + s}, 0.5, light);
            };
            CHECK(at.by.sigma_s == Approx((of(0, h) - of(0, -h)) / (2 * h)).epsilon(1e-3));
            CHECK(at.by.sigma_a == Approx((of(h, 0) - at.value) / h).epsilon(1e-2));
        }
}

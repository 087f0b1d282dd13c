// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <cmath>

#include "optics/monte_carlo/monte_carlo.h"
#include "optics/profiles/layered_profile_model.h"
#include "tests/optics/transport/slab_scene.h"

using namespace voxtone::optics;
using namespace voxtone::optics::testing;

namespace {

double root_mean_square(const Appearance& model, const Appearance& truth) {
    double sum = 0;
    for (std::size_t i = 0; i < truth.value.size(); ++i) {
        const double off = model.value[i] - truth.value[i];
        sum += off * off;
    }
    return std::sqrt(sum / static_cast<double>(truth.value.size()));
}

}  // namespace

TEST_CASE("An edge is blurred by layer profiles as paths blur it, within the model's error, sharp it is not") {
    const ResinSet set = vero_opaque();
    const auto W = static_cast<Material>(set.find("W") + 1), K = static_cast<Material>(set.find("K") + 1);
    const ResinVolume volume =
        make_resin_volume({96, 4, 74}, slab_pitch_mm, [&](int x, int, int) { return x < 48 ? W : K; });
    const Scene scene{&volume, &set, Backing::black, Sides::mirrored};
    const Surface surface = find_surface(scene, {4, 2, 6}, SurfacePart::top);
    MonteCarloOptions options;
    options.paths = 4096;
    const Appearance truth = MonteCarlo(options).predict(scene, surface);
    // docs/laminate-search.md: 0.046 and 0.142.
    CHECK(root_mean_square(LayeredProfileModel().predict(scene, surface), truth) < 0.055);
    CHECK(root_mean_square(LayeredProfileModel({.sideways = false}).predict(scene, surface), truth) > 0.12);
}

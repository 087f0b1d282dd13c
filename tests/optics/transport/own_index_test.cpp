// SPDX-License-Identifier: GPL-3.0-or-later
//
// Resins that name an index and a g of their own, by the fast predictor.
#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <vector>

#include "optics/monte_carlo/monte_carlo.h"
#include "optics/transport/transport.h"
#include "tests/optics/transport/slab_scene.h"

using namespace voxtone::optics;
using namespace voxtone::optics::testing;

namespace {

std::array<double, 3> means(const AppearanceModel& model, const ResinSet& set, const ResinVolume& volume) {
    const Scene scene{&volume, &set, Backing::black, Sides::mirrored};
    const Appearance seen = model.predict(scene, find_surface(scene, {2, 1, 3}, SurfacePart::top));
    std::array<double, 3> sum{};
    for (std::size_t i = 0; i < seen.value.size(); ++i)
        sum[i % 3] += static_cast<double>(seen.value[i]) / static_cast<double>(seen.value.size() / 3);
    return sum;
}

}  // namespace

TEST_CASE("what a resin's own index changes on a slab is, to the fast predictor, what adding-doubling has") {
    const std::vector<SlabLayer> slab{{3, 60}};  // yellow: white in two channels, dark in the third
    const ResinVolume volume = slab_volume(slab, 64, 32);
    const ResinSet plain = vero_opaque();
    const TransportPredictor model;
    const auto before = means(model, plain, volume);
    for (const double eta : {1.48, 1.53}) {
        ResinSet own = plain, of_set = plain;
        own.resins[2].eta = eta, of_set.eta = eta;
        const auto after = means(model, own, volume);
        for (std::size_t c = 0; c < 3; ++c) {
            const double exact =
                exact_appearance(of_set, slab, Backing::black, c) / exact_appearance(plain, slab, Backing::black, c) -
                1;
            INFO(eta << " channel " << c << ": " << after[c] / before[c] - 1 << ", exact " << exact);
            // 0.005 of light returns in the dark channel, mostly scattered once.
            CHECK(std::abs(after[c] / before[c] - 1 - exact) < (c < 2 ? 0.05 : 0.25) * std::abs(exact));
        }
    }
}

TEST_CASE("a halftone of resins of their own index or g looks to the fast predictor as it does by light paths",
          "[slow]") {
    const ResinVolume volume = make_resin_volume({64, 32, 40}, slab_pitch_mm, [](int x, int y, int z) {
        return (x * 7 + y * 5 + z * 3) % 16 < 3 ? 4 : 5;  // three voxels of black in sixteen
    });
    const ResinSet plain = vero_opaque();
    ResinSet own = plain;
    if (GENERATE(false, true))
        own.resins[4].g = 0.3;
    else
        for (Resin& resin : own.resins) resin.eta = resin.role == "K" ? 1.4 : 1.6;
    own.relate();
    const MonteCarlo paths({.paths = 256});
    const TransportPredictor fast;
    const auto of_paths = means(paths, own, volume), paths_before = means(paths, plain, volume);
    const auto of_fast = means(fast, own, volume), fast_before = means(fast, plain, volume);
    for (std::size_t c = 0; c < 3; ++c) {
        const double by_paths = of_paths[c] / paths_before[c] - 1, by_fast = of_fast[c] / fast_before[c] - 1;
        INFO(c << ": changed by " << by_paths << " by paths, " << by_fast << " fast");
        CHECK(std::abs(by_paths) > 0.05);
        CHECK(std::abs(by_fast - by_paths) < 0.2 * std::abs(by_paths));
    }
}

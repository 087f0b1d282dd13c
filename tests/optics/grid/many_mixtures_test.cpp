// SPDX-License-Identifier: GPL-3.0-or-later
//
// A print with more different cells than a grid has numbers for: what is lost where layers are forgotten and shares
// rounded (homogenisation.h).
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "optics/grid/viewing_grid_builder.h"
#include "optics/grid/viewing_tiles.h"
#include "optics/transport/transport.h"
#include "tests/optics/transport/slab_scene.h"
#include "tests/outcomes.h"

using namespace voxtone;
using namespace voxtone::optics;

TEST_CASE("A print of more different cells than have numbers looks as it does with fewer names for the same resins") {
    // White goes by six names, so that a cell of six voxels is one of 166,000 mixtures in layers; of one of 48 the
    // counts alone are too many. By one name they are few.
    const bool fine = GENERATE(false, true);
    CAPTURE(fine);
    constexpr int names = 6;
    const ResinSet plain = vero_opaque();
    ResinSet many = plain;
    for (int k = 1; k < names; ++k) {
        Resin white = plain.resins[4];
        white.name = white.role = "white " + std::to_string(k);
        many.resins.push_back(white);
    }
    const std::array<int, 3> size = fine ? std::array{288, 144, 144} : std::array{192, 96, 48},
                             cell = fine ? std::array{4, 2, 6} : std::array{2, 1, 3};
    std::array<double, 3> pitch_mm = testing::slab_pitch_mm;
    for (double& pitch : pitch_mm) pitch /= fine ? 2 : 1;
    const auto print = [&](bool named) {
        return make_resin_volume(size, pitch_mm, [&](int x, int y, int z) {
            RandomStream random(1, static_cast<std::uint64_t>((z * size[1] + y) * size[0] + x));
            const int tenth = std::min(9, static_cast<int>(10 * random.uniform()));
            if (tenth < 4) return 1 + tenth;
            return named ? 5 + std::min(names - 1, static_cast<int>(names * random.uniform())) : 5;
        });
    };
    const ResinVolume of_many = print(true), of_few = print(false);
    // Of what the grid's cells hold: does any part `is_so`?
    const auto any = [&](const ResinVolume& volume, const ResinSet& set, const auto& is_so) {
        const ViewingGrid grid = make_viewing_grid({&volume, &set, Backing::black, Sides::mirrored}, cell, {0.8}, {},
                                                   {{}, BlockLattice(volume.size(), cell).blocks, {}});
        return std::ranges::any_of(grid.mixtures,
                                   [&](const auto& mixture) { return std::ranges::any_of(mixture.holds, is_so); });
    };
    const auto tells_layer = [](const Holding& held) { return held.layer > 0; };
    const auto is_counted = [](const Holding& held) { return std::fmod(8 * held.share, 1.0F) != 0; };
    REQUIRE(any(of_few, plain, tells_layer) == !fine);
    REQUIRE(any(of_few, plain, is_counted));
    REQUIRE_FALSE(any(of_many, many, tells_layer));
    REQUIRE(any(of_many, many, is_counted) == !fine);

    TransportOptions options;
    options.refinement = Refinement::none;
    const TransportPredictor predictor(options);
    const auto seen = [&](const ResinVolume& volume, const ResinSet& set) {
        const Scene scene{&volume, &set, Backing::black, Sides::mirrored};
        return predictor.predict(scene, find_surface(scene, cell, SurfacePart::top)).value;
    };
    const std::vector<float> rounded = seen(of_many, many), exact = seen(of_few, plain);
    REQUIRE(rounded.size() == exact.size());
    double bias = 0, squares = 0, spread = 0, mean = 0;
    for (const float v : exact) mean += double(v) / double(exact.size());
    for (std::size_t i = 0; i < exact.size(); ++i) {
        const double off = double(rounded[i]) - double(exact[i]);
        bias += off / double(exact.size());
        squares += off * off / double(exact.size());
        spread += std::pow(double(exact[i]) - mean, 2) / double(exact.size());
    }
    CAPTURE(mean, std::sqrt(spread), bias, std::sqrt(squares));
    // The amounts of resin stay on average, cell by cell as many as are counted.
    CHECK(std::abs(bias) < 0.01 * mean);
    CHECK(std::sqrt(squares - bias * bias) < 0.25 * std::sqrt(spread));
}

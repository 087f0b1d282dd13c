// SPDX-License-Identifier: GPL-3.0-or-later
//
// A print with more different cells than a grid has numbers for: what is lost where layers are forgotten and shares
// rounded (viewing_palette.h).
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "optics/transport/transport.h"
#include "optics/transport/viewing_grid_builder.h"
#include "optics/transport/viewing_tiles.h"
#include "tests/optics/transport/slab_scene.h"
#include "tests/outcomes.h"

using namespace voxtone;
using namespace voxtone::optics;

TEST_CASE("A print of more different cells than have numbers looks as it does with fewer names for the same resins") {
    // White goes by six names, so that a cell of six voxels is one of 166,000 mixtures; by one name they are few.
    const ResinSet plain = vero_opaque();
    ResinSet many = plain;
    for (int k = 0; k < 5; ++k) {
        Resin white = plain.resins[4];
        white.name = white.role = "white " + std::to_string(k);
        many.resins.push_back(white);
    }
    constexpr std::array<int, 3> size{192, 96, 48}, cell{2, 1, 3};
    const auto print = [&](bool named) {
        return make_resin_volume(size, testing::slab_pitch_mm, [&](int x, int y, int z) {
            RandomStream random(1, static_cast<std::uint64_t>((z * size[1] + y) * size[0] + x));
            const int resin = 1 + std::min(9, static_cast<int>(10 * random.uniform()));
            return named ? resin : std::min(resin, 5);
        });
    };
    const ResinVolume of_many = print(true), of_few = print(false);
    const auto tells_layers = [&](const ResinVolume& volume, const ResinSet& set) {
        const ViewingGrid grid = make_viewing_grid({&volume, &set, Backing::black, Sides::mirrored}, cell, {0.8}, {},
                                                   {{}, BlockLattice(volume.size(), cell).blocks, {}});
        return std::ranges::any_of(grid.mixtures, [](const ViewingGrid::Mixture& mixture) {
            return std::ranges::any_of(mixture.holds, [](const auto& held) { return held.layer > 0; });
        });
    };
    REQUIRE(tells_layers(of_few, plain));
    REQUIRE_FALSE(tells_layers(of_many, many));

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
    // Eighths that are left over go to the resins with the lowest numbers, here the inks: too dark by 0.12 of the mean.
    WANTED(std::abs(bias) < 0.01 * mean);
    CHECK(std::abs(bias) < 0.13 * mean);
    // Cell by cell nothing else is lost.
    CHECK(std::sqrt(squares - bias * bias) < 0.25 * std::sqrt(spread));
}

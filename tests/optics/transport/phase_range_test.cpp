// SPDX-License-Identifier: GPL-3.0-or-later
//
// Phase functions and refractive indices other than Vero's: the fast predictor, on cells of the eye and on voxels,
// against adding-doubling, and the gradient of cells against differences, over the range that transport.h claims.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "optics/grid/transport_directions.h"
#include "optics/transport/transport.h"
#include "optics/transport/viewing_sequence.h"
#include "tests/optics/transport/slab_scene.h"

using namespace voxtone::optics;
using namespace voxtone::optics::testing;

namespace {

/// Resins of one channel.
ResinSet one_channel(double g, double eta, const std::vector<Medium>& media) {
    ResinSet set;
    set.g = g;
    set.eta = eta;
    set.channels.wavelengths_nm = {550};
    for (const Medium& m : media) {
        const std::string role(1, static_cast<char>('a' + set.resins.size()));
        set.resins.push_back({role, role, {m.sigma_t()}, {m.albedo()}});
    }
    return set;
}

}  // namespace

TEST_CASE("Diffuse light goes as far as the phase function says, and no source is negative") {
    for (double g = -0.95; g < 0.96; g += 0.05) {
        const DirectionSet set = make_directions(g, 1.5);
        INFO("g " << g);
        CHECK((1 - set.forward_peak) * (1 - set.linear) == Approx(1 - g).epsilon(1e-12));
        CHECK(std::abs(3 * set.linear) <= 1 + 1e-12);
    }
}

TEST_CASE("Slabs of any phase function and index agree with adding-doubling", "[slow]") {
    const double g = GENERATE(-0.3, 0.0, 0.4, 0.7), eta = GENERATE(1.0, 1.33, 1.5);
    // White, a middle tone, a dark one, and a thin scatterer; sigma_s' is alike for all g, as it would be measured.
    const double s = 1 / (1 - g);
    const std::vector<Medium> media{{0.005, 6 * s}, {0.4, 4 * s}, {3, 2 * s}, {0.02, 0.6 * s}};
    // As docs/predict.md states them, each rounded up from the worst of these slabs. The phase function's higher terms
    // are seen where light is scattered about once.
    const std::array<double, 4> worst{0.001, 0.001, 0.0005, g > 0.5 ? 0.019 : 0.006};
    const ResinSet set = one_channel(g, eta, media);
    TransportOptions options;
    options.sweeps = 6;
    options.refinement = GENERATE(Refinement::none, Refinement::all);
    const TransportPredictor model(options);
    for (std::size_t m = 0; m < media.size(); ++m) {
        const SlabLayer layer{static_cast<Material>(m + 1), 60};
        const ResinVolume volume = slab_volume({&layer, 1}, 64, 32);
        const Scene scene{&volume, &set, Backing::black, Sides::mirrored};
        const Surface surface = find_surface(scene, {2, 1, 3}, SurfacePart::top);
        const Appearance seen = model.predict(scene, surface);
        double mean = 0;
        for (const float v : seen.value) mean += static_cast<double>(v) / static_cast<double>(seen.value.size());
        const double exact = exact_appearance(set, {&layer, 1}, Backing::black, 0);
        INFO("g " << g << ", eta " << eta << ", medium " << m
                  << (options.refinement == Refinement::none ? ", cells" : ", voxels") << ": " << mean << ", exact "
                  << exact);
        CHECK(std::abs(mean - exact) < worst[m]);
    }
}

TEST_CASE("The gradient by scattering agrees with differences for any phase function and index") {
    const double g = GENERATE(-0.3, 0.0, 0.4, 0.7), eta = GENERATE(1.0, 1.33, 1.5);
    // They absorb alike: what tells them apart is scattering alone.
    const double s = 1 / (1 - g);
    const ResinSet set = one_channel(g, eta, {{0.05, 6 * s}, {0.05, 3 * s}});
    const std::array<int, 3> size{24, 12, 60};
    const auto draw = [&](int x, int y, int z) {
        const auto address = static_cast<std::uint64_t>((z * size[1] + y) * size[0] + x);
        return voxtone::RandomStream(5, address).uniform();
    };
    const auto chosen = [&](int x, int y, int z) { return z >= size[2] - 12 && draw(x, y, z) < 0.17; };
    // What stays is of both: all cells of a layer of one would be rounded alike where light is kept, 16 bits a value,
    // and their errors add up to a tenth of the derivative.
    const auto print = [&](bool changed) {
        return make_resin_volume(size, slab_pitch_mm, [&](int x, int y, int z) {
            return (changed && chosen(x, y, z)) || draw(x, y, z) > 0.7 ? 2 : 1;
        });
    };
    const ResinVolume before = print(false), after = print(true);
    const Scene scene{&before, &set, Backing::black, Sides::mirrored};
    const Surface surface = find_surface(scene, {2, 1, 3}, SurfacePart::top);
    TransportOptions options;
    options.refinement = Refinement::none;
    options.sweeps = options.next_sweeps = options.adjoint_sweeps = 12;
    options.next_change = options.first_change = 0;
    ViewingSequence sequence(scene, surface, options);
    const std::vector<float> weight(surface.cells.size(), 1.0f);
    double difference = 0, expected = 0;
    for (const bool changed : {false, true}) {
        for (const float v : sequence.next(changed ? after : before).value)
            difference += changed ? static_cast<double>(v) : -static_cast<double>(v);
        // The mean of the derivatives before and after is right to second order.
        REQUIRE(sequence.gradient(weight, [&](const ResinGradient& gradient, const VoxelBox& box) {
            for (int z = size[2] - 12; z < size[2]; ++z)
                for (int y = 0; y < size[1]; ++y)
                    for (int x = 0; x < size[0]; ++x)
                        if (chosen(x, y, z) && box.holds({x, y, z}))
                            expected +=
                                0.5 * static_cast<double>(gradient.at({x, y, z}, 1) - gradient.at({x, y, z}, 0));
        }));
    }
    INFO("g " << g << ", eta " << eta << ": difference " << difference << ", gradient " << expected);
    CHECK(difference < 0);
    CHECK(expected / difference == Approx(1).epsilon(0.05));
}

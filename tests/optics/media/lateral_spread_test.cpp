// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/media/lateral_spread.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/random.h"
#include "optics/monte_carlo/monte_carlo.h"
#include "optics/scene/surface.h"
#include "optics/transport/transport.h"

using namespace voxtone;
using namespace voxtone::optics;

namespace {

constexpr std::array<double, 3> j750_mm{0.04233, 0.08467, 0.027};

double drawn(int x, int y, int z) {
    return unit_interval(philox4x32({std::uint32_t(x), std::uint32_t(y), std::uint32_t(z), 0}, {7, 7})[0]);
}

/// Of the cells of an eye; one that is as large as the slab would be looked at here and there.
double mean_seen(const Scene& scene, const AppearanceModel& model, std::size_t channel) {
    const Surface surface = find_surface(scene, {2, 1, 3}, SurfacePart::top);
    const Appearance seen = model.predict(scene, surface);
    double sum = 0;
    for (std::size_t cell = 0; cell < surface.cells.size(); ++cell)
        sum += double(seen.value[cell * seen.channels + channel]);
    return sum / double(surface.cells.size());
}

}  // namespace

TEST_CASE("The weights of a spread have its variance and that of two voxels, and sum to 1", "[spread]") {
    for (const double sigma : {0.03, 0.1, 0.3}) {  // narrower ones leave most resin in its voxel
        const LateralSpread spread({sigma, 0}, j750_mm);
        REQUIRE(spread.any());
        CHECK(spread.reach()[1] == 0);
        const auto weights = spread.weights(0);
        double sum = 0, variance = 0;
        for (std::size_t k = 0; k < weights.size(); ++k) {
            const double step = (double(k) - spread.reach()[0]) * j750_mm[0];
            sum += double(weights[k]);
            variance += double(weights[k]) * step * step;
        }
        CHECK(sum == Approx(1).epsilon(1e-6));
        CHECK(variance == Approx(sigma * sigma + j750_mm[0] * j750_mm[0] / 6).epsilon(2e-3));
    }
    CHECK_FALSE(LateralSpread({0, 0}, j750_mm).any());
    CHECK(LateralSpread({0, 0}, j750_mm).kept_variance() == 1);
    CHECK(LateralSpread({0.05, 0.05}, j750_mm).kept_variance() < 0.2);
}

TEST_CASE("Spread resin keeps the volume of each resin, none of it up, down or out of the body", "[spread]") {
    const std::array<int, 3> size{20, 11, 6};
    const ResinVolume volume = make_resin_volume(size, j750_mm, [](int x, int y, int z) {
        if ((x - 9) * (x - 9) + 4 * (y - 5) * (y - 5) > 90 || (x == 8 && y > 3)) return 0;
        return z == 2 ? 3 : drawn(x, y, z) < 0.3 ? 1 : 2;
    });
    const LateralSpread spread({0.07, 0.1}, j750_mm);
    SpreadBox box(volume, false, spread, 3);
    box.read({0, 0, 0}, size);
    std::array<double, 3> sum{};
    std::size_t i = 0;
    for (int z = 0; z < size[2]; ++z)
        for (int y = 0; y < size[1]; ++y)
            for (int x = 0; x < size[0]; ++x, ++i) {
                const auto holds = box.shares(i);
                const double all = std::accumulate(holds.begin(), holds.end(), 0.0);
                CHECK(box.is_air(i) == (volume.at(x, y, z) == air));
                CHECK(all == Approx(volume.at(x, y, z) == air ? 0 : 1).margin(1e-5));
                if (z == 2 && all > 0) CHECK(holds[2] == Approx(1));
                if (z != 2) CHECK(double(holds[2]) == 0);
                for (std::size_t r = 0; r < 3; ++r) sum[r] += double(holds[r]);
            }
    const auto count = volume.count();
    for (std::size_t r = 0; r < 3; ++r) CHECK(sum[r] == Approx(double(count[r + 1])).epsilon(1e-5));

    // The same whatever box is asked for, and a box that nothing else reaches is told.
    SpreadBox part(volume, false, spread, 3);
    part.read({5, 3, 1}, {4, 2, 3});
    const auto whole = box.shares((1 * 11 + 3) * 20 + 5), same = part.shares(0);
    CHECK(std::ranges::equal(whole, same));
    CHECK(part.only({5, 3, 1}, {4, 2, 1}) == -1);
    CHECK(part.only({5, 3, 2}, {4, 2, 1}) == 3);
}

TEST_CASE("Light paths through spread voxels see what they see in voxels of the mixtures", "[spread][slow]") {
    // Stripes so fine that a mixture hardly changes within a voxel.
    constexpr int wide = 32;
    constexpr double sigma = 0.06;
    const std::array<double, 3> pitch{0.01, 0.02, 0.02};
    const ResinSet set = vero_opaque();
    const auto is_black = [](int x) { return x % wide >= wide / 2; };
    const ResinVolume stripes =
        make_resin_volume({wide, 8, 20}, pitch, [&](int x, int, int) { return is_black(x) ? 4 : 5; });
    const LateralSpread spread({sigma, 0}, pitch);
    SpreadBox box(stripes, true, spread, set.resins.size());
    box.read({0, 0, 0}, {wide, 1, 1});
    ResinSet mixed = set;
    mixed.resins.clear();
    for (std::size_t x = 0; x < wide; ++x) {
        const std::vector<double> shares(box.shares(x).begin(), box.shares(x).end());
        Resin resin{"mixture", "m" + std::to_string(x), {}, {}};
        for (std::size_t c = 0; c < 3; ++c) {
            const Medium medium = set.mix(shares, c);
            resin.sigma_t_per_mm.push_back(medium.sigma_t());
            resin.albedo.push_back(medium.albedo());
        }
        mixed.resins.push_back(resin);
    }
    const ResinVolume mixtures = make_resin_volume({wide, 8, 20}, pitch, [&](int x, int, int) { return x + 1; });
    const MonteCarlo model({.paths = 1000});
    for (const std::size_t channel : {0u, 1u}) {
        Scene scene{&stripes, &set, Backing::black, Sides::mirrored};
        const double sharp = mean_seen(scene, model, channel);
        scene.spread_mm = {sigma, 0};
        const double run = mean_seen(scene, model, channel),
                     exact = mean_seen({&mixtures, &mixed, Backing::black, Sides::mirrored}, model, channel);
        INFO("channel " << channel << ": sharp " << sharp << ", spread " << run << ", mixtures " << exact);
        CHECK(std::abs(run - exact) < 0.003);
        CHECK(sharp - run > 0.008);
    }
}

TEST_CASE("The predictor follows Monte Carlo of spread voxels, in whole cells and in parts", "[spread][slow]") {
    const ResinSet set = vero_opaque();
    const ResinVolume halftone = make_resin_volume({48, 24, 30}, j750_mm, [](int x, int y, int z) {
        const double u = drawn(x, y, z);
        return z < 12 ? 5 : u < 0.25 ? 1 : u < 0.45 ? 3 : u < 0.5 ? 4 : 5;
    });
    const MonteCarlo paths({.paths = 1000});
    for (const Refinement refinement : {Refinement::none, Refinement::contrast}) {
        TransportOptions options;
        options.refinement = refinement;
        const TransportPredictor predictor(options);
        for (const std::size_t channel : {0u, 2u}) {
            Scene scene{&halftone, &set, Backing::black, Sides::mirrored};
            const double sharp = mean_seen(scene, paths, channel);
            scene.spread_mm = {0.06, 0.06};
            const double run = mean_seen(scene, paths, channel), predicted = mean_seen(scene, predictor, channel);
            INFO("channel " << channel << ": sharp " << sharp << ", spread " << run << ", predicted " << predicted);
            CHECK(std::abs(predicted - run) < 0.35 * std::abs(sharp - run));
        }
    }
}

TEST_CASE("The widest spread is none too wide for the predictor where droplets run too", "[spread]") {
    ResinSet set = vero_opaque();
    set.dot_spread = 1;
    const ResinVolume halftone = make_resin_volume({48, 24, 15}, j750_mm, [](int x, int y, int z) {
        return z < 6 ? 5 : drawn(x, y, z) < 0.3 ? 1 : 5;
    });
    Scene scene{&halftone, &set, Backing::black, Sides::mirrored};
    const TransportPredictor predictor(TransportOptions{});
    const double own = mean_seen(scene, predictor, 0);
    scene.spread_mm = {widest_spread_mm, widest_spread_mm};
    // An even halftone looks the same, however far what has run already runs.
    CHECK(std::abs(mean_seen(scene, predictor, 0) - own) < 0.01);
}

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Separation (lattice, look-ups), screens (selection, error diffusion), and the making of a screen's tile.
#include <benchmark/benchmark.h>

#include <array>
#include <cstdint>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "halftone/screens/blue_noise_screen.h"
#include "halftone/screens/built_in_screens.h"
#include "halftone/screens/error_diffusion.h"
#include "halftone/screens/void_and_cluster.h"
#include "halftone/separation/mixture.h"
#include "halftone/separation/mixture_lattice.h"
#include "halftone/separation/separation.h"

namespace {

using namespace voxtone;
using namespace voxtone::halftone;

constexpr int resins = 5;

/// As `slice` has it; `ideal`: mixtures by Eq. 7.
optics::ShellAppearance vero(bool ideal = false) {
    const optics::ResinSet set = optics::vero_opaque();
    optics::ShellGeometry geometry;
    geometry.core_resin = set.find("W");
    if (!ideal) geometry.pitch_mm = built_in_screens[0].pitch_mm;
    return optics::ShellAppearance(set, geometry);
}

struct Colours {
    std::vector<float> r, g, b;
};

/// `step`: how far a colour is from the one before it; 1 makes them independent.
Colours walk(std::size_t n, double step) {
    Colours c{std::vector<float>(n), std::vector<float>(n), std::vector<float>(n)};
    RandomStream random(1, 0);
    std::array<double, 3> at{0.5, 0.5, 0.5};
    for (std::size_t i = 0; i < n; ++i) {
        for (double& x : at) x = (1 - step) * x + step * random.uniform();
        c.r[i] = static_cast<float>(at[0]), c.g[i] = static_cast<float>(at[1]), c.b[i] = static_cast<float>(at[2]);
    }
    return c;
}

std::vector<CumulativeMixture> mixtures_of(std::size_t n) {
    const optics::ShellAppearance appearance = vero();
    const Separation separation(appearance);
    const Colours c = walk(n, 0.05);
    std::vector<CumulativeMixture> mixtures(n);
    separation.mixtures(c.r.data(), c.g.data(), c.b.data(), n, mixtures.data());
    return mixtures;
}

/// Argument: 1 for ideal mixtures.
void separation_lattice(benchmark::State& state) {
    const optics::ShellAppearance appearance = vero(state.range(0) == 1);
    const AppearanceColour colour(appearance, {});
    for (auto _ : state) {
        MixtureLattice lattice(colour, {});
        parallel_for(0, lattice.nodes(), 4, [&](std::size_t node) { benchmark::DoNotOptimize(lattice.at(node)); });
    }
}
BENCHMARK(separation_lattice)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

/// Argument: step of the walk through colours in percent (5: a picture; 100: independent colours).
void separation_lookup(benchmark::State& state) {
    constexpr std::size_t n = 4096;
    const optics::ShellAppearance appearance = vero();
    const Separation separation(appearance);
    const Colours c = walk(n, static_cast<double>(state.range(0)) / 100);
    std::vector<CumulativeMixture> mixtures(n);
    for (auto _ : state) {
        separation.mixtures(c.r.data(), c.g.data(), c.b.data(), n, mixtures.data());
        benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * n));
}
BENCHMARK(separation_lookup)->Arg(5)->Arg(100);

void screen_select(benchmark::State& state) {
    constexpr int n = 4096;
    const BlueNoiseScreen screen(built_in_screens[0].pitch_mm);
    const std::vector<CumulativeMixture> mixtures = mixtures_of(n);
    std::vector<std::uint8_t> out(n);
    int j = 0;
    for (auto _ : state) {
        const std::uint16_t* row = screen.row(++j, 7);
        for (int i = 0; i < n; ++i)
            out[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(
                select_resin(mixtures[static_cast<std::size_t>(i)], row[i & BlueNoiseScreen::mask], resins));
        benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * n));
}
BENCHMARK(screen_select);

void error_diffusion_layer(benchmark::State& state) {
    constexpr int edge = 256;
    ErrorDiffusionOptions options;
    options.pitch_mm = built_in_screens[0].pitch_mm;
    ErrorDiffusion diffusion(edge, edge, resins, options);
    const std::vector<CumulativeMixture> mixtures = mixtures_of(edge * edge);
    const std::vector<std::uint8_t> body(edge * edge, 1);
    std::vector<std::uint8_t> out(edge * edge);
    int k = 0;
    for (auto _ : state) diffusion.layer(k++, mixtures, body, out);
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * edge * edge));
}
BENCHMARK(error_diffusion_layer);

void make_tile(benchmark::State& state) {
    VoidAndClusterOptions options;
    options.pitch_mm = built_in_screens[0].pitch_mm;
    for (auto _ : state) benchmark::DoNotOptimize(void_and_cluster(options).data());
}
BENCHMARK(make_tile)->Unit(benchmark::kSecond)->Iterations(1);

}  // namespace

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Light paths per second: the plain scalar loop beside packets. Run:
//   build/release/benchmarks/monte_carlo_benchmark
// Rows: scene / tracer (0 packets, 1 plain) / threads. A path is one of one channel; all three channels of Vero Opaque
// take part. paths/s counts the clock on the wall, paths/core_s the processor time of all threads, so that other work
// on the machine counts little.
#include <array>
#include <chrono>
#include <cmath>

#include <benchmark/benchmark.h>

#include "base/parallel.h"
#include "base/random.h"
#include "optics/monte_carlo/monte_carlo.h"

namespace {

using namespace voxtone;
using namespace voxtone::optics;

constexpr std::array<double, 3> j750{0.0423333, 0.0846667, 0.027};
constexpr Material C = 1, K = 4, W = 5;

/// One of five resins per voxel, by its address.
Material any_resin(int x, int y, int z) {
    const auto bits = philox4x32(
        {static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), static_cast<std::uint32_t>(z), 0}, {1, 2});
    return static_cast<Material>(1 + bits[0] % 5);
}

template <class MaterialOf>
void paths_per_second(benchmark::State& state, int layers, MaterialOf&& material_of) {
    const ThreadLimit limit(static_cast<std::size_t>(state.range(1)));
    const ResinSet set = vero_opaque();
    const ResinVolume volume = make_resin_volume({96, 48, layers}, j750, material_of);
    const Scene scene{&volume, &set, Backing::black, Sides::mirrored};
    const Surface surface = find_surface(scene, {2, 1, 3}, SurfacePart::top);
    const auto tracer = state.range(0) == 0 ? PathTracer::packets : PathTracer::scalar;
    MonteCarloSummary summary;
    std::uint64_t paths = 0;
    MonteCarloOptions options{.paths = tracer == PathTracer::scalar ? 4u : 16u, .tracer = tracer};
    const auto start = std::chrono::steady_clock::now();
    for (auto _ : state) {
        benchmark::DoNotOptimize(MonteCarlo(options).predict(scene, surface, summary));
        options.first_path += options.paths;
        paths += summary.paths;
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    state.counters["paths/s"] = static_cast<double>(paths) / seconds;
    state.counters["paths/core_s"] = benchmark::Counter(static_cast<double>(paths), benchmark::Counter::kIsRate);
}

void thin_cyan(benchmark::State& state) {
    paths_per_second(state, 9, [](int, int, int) { return C; });  // 0.24 mm
}
void thick_black(benchmark::State& state) {
    paths_per_second(state, 120, [](int, int, int) { return K; });  // 3.24 mm
}
void thick_white(benchmark::State& state) {
    paths_per_second(state, 120, [](int, int, int) { return W; });
}
void halftone_over_white(benchmark::State& state) {  // 0.49 mm of all resins
    paths_per_second(state, 120, [](int x, int y, int z) { return z < 102 ? W : any_resin(x, y, z); });
}
void halftone_throughout(benchmark::State& state) {
    paths_per_second(state, 120, [](int x, int y, int z) { return any_resin(x, y, z); });
}
void sphere(benchmark::State& state) {  // white with a coloured skin, 3.2 mm
    paths_per_second(state, 120, [](int x, int y, int z) {
        const double r = std::hypot((x - 47.5) * j750[0], (y - 23.5) * j750[1], (z - 59.5) * j750[2]);
        return r > 1.6 ? air : r > 1.1 ? any_resin(x, y, z) : W;
    });
}

void rows(benchmark::internal::Benchmark* b) {
    for (const int threads : {1, 2})
        for (const int tracer : {1, 0}) b->Args({tracer, threads});
    b->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
}
BENCHMARK(thin_cyan)->Apply(rows);
BENCHMARK(thick_black)->Apply(rows);
BENCHMARK(thick_white)->Apply(rows);
BENCHMARK(halftone_over_white)->Apply(rows);
BENCHMARK(halftone_throughout)->Apply(rows);
BENCHMARK(sphere)->Apply(rows);

}  // namespace

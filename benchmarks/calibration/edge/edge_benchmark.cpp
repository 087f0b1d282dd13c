// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a profile between the records costs, and a fit of Vero's ten slabs. Run: build/release/benchmarks/edge_benchmark
#include <benchmark/benchmark.h>

#include "benchmarks/calibration/edge/edge_rehearsal.h"

namespace {

using namespace voxtone;
using namespace voxtone::calibration;

EdgeProfileTable& table() {
    static EdgeProfileTable made = [] {
        EdgeProfileTable all(rehearsal::dictionary("", {0.4}, 1u << 14), rehearsal::assumed_setup());
        all.prepare(0.4, false);
        return all;
    }();
    return made;
}

// Another resin every time. 1: seen by the camera, 362 samples.
void profile(benchmark::State& state) {
    const EdgeSetup& setup = table().setup();
    const Eigen::MatrixXd see =
        optics::pixels_from_cells(table().geometry(), setup.positions(), {setup.pitch_mm, setup.blur_mm, 1});
    double sigma_t = 5;
    for (auto _ : state) {
        sigma_t += 1e-6;
        Eigen::VectorXd F = table().cells(0, 1, {sigma_t, 0.97, 0.4});
        if (state.range(0) == 1) F = see * F;
        benchmark::DoNotOptimize(F.data());
    }
}
BENCHMARK(profile)->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

// Five resins, three channels, mu from 0.8 to 1.1, errors; the table is prepared already. CPU time of all threads.
void fit(benchmark::State& state) {
    static const std::vector<EdgeProfile> profiles = rehearsal::measured(optics::vero_opaque(), 1u << 14, 1);
    for (auto _ : state) benchmark::DoNotOptimize(fit_edges(profiles, table(), {}).mu);
}
BENCHMARK(fit)->Unit(benchmark::kSecond)->Iterations(1)->MeasureProcessCPUTime()->UseRealTime();

// Solving the table's profiles at one g: 48 runs, 20 albedos, three channels.
void prepare(benchmark::State& state) {
    const auto dictionary = rehearsal::dictionary("", {0.4}, 2048);
    for (auto _ : state) {
        EdgeProfileTable fresh(dictionary, rehearsal::assumed_setup());
        fresh.prepare(0.4, false);
        benchmark::DoNotOptimize(&fresh);
    }
}
BENCHMARK(prepare)->Unit(benchmark::kSecond)->Iterations(1)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace

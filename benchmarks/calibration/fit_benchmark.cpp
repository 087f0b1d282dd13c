// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a calibration's patches and fits cost. Run: build/release/benchmarks/calibration/fit_benchmark
#include <vector>

#include <benchmark/benchmark.h>

#include "../../tests/calibration/target_samples.h"

namespace {

using namespace voxtone;
using namespace voxtone::calibration;
using optics::Medium;

// 0.675 mm of cyan upon deep white, 15 directions, both new every time; 1: with all four derivatives.
void two_layer_stack(benchmark::State& state) {
    const bool derivatives = state.range(0) == 1;
    const optics::ResinSet set = optics::vero_opaque();
    const auto plan = patch_plan({});
    Medium top = set.resins[0].medium(2), base = set.resins[4].medium(2);
    for (auto _ : state) {
        top.sigma_a += 1e-9, base.sigma_a += 1e-9;
        const optics::OrdinateBase below(*plan, base, derivatives);
        benchmark::DoNotOptimize(optics::OrdinateLayer(*plan, top, 0.675, derivatives).upon(below));
    }
}
BENCHMARK(two_layer_stack)->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

// All 20 patches of target B for five resins, one channel; time per patch. 1: with the whole Jacobian.
void target_b(benchmark::State& state) {
    const PatchTable table = testing::target('B', {"C", "M", "Y"});
    const PatchModel model(table.patches, {"C", "M", "Y", "K", "W"}, {});
    const optics::ResinSet set = optics::vero_opaque();
    std::vector<Medium> resins;
    for (const auto& resin : set.resins) resins.push_back(resin.medium(2));
    std::vector<double> rho(table.patches.size());
    Eigen::MatrixXd by_resin;
    for (auto _ : state) {
        resins[0].sigma_a += 1e-9;
        if (state.range(0) == 1) model.evaluate(resins, model.bases(resins, true), rho, by_resin);
        else model.evaluate(resins, model.bases(resins, false), rho);
        benchmark::DoNotOptimize(rho.data());
    }
    state.counters["patch"] =
        benchmark::Counter(static_cast<double>(rho.size()), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(target_b)->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

}  // namespace

// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a calibration's patches and fits cost. Run: build/release/benchmarks/fit_benchmark
#include <algorithm>
#include <vector>

#include <benchmark/benchmark.h>

#include "calibration/fit/resin_fit.h"
#include "tests/calibration/patches/target_samples.h"

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
        if (state.range(0) == 1)
            model.evaluate(resins, model.bases(resins, true), rho, by_resin);
        else
            model.evaluate(resins, model.bases(resins, false), rho);
        benchmark::DoNotOptimize(rho.data());
    }
    state.counters["patch"] = benchmark::Counter(
        static_cast<double>(rho.size()), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(target_b)->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

// Vero between 380 and 780 nm: its blue, green and red joined by straight lines.
optics::ResinSet spectral(double step_nm) {
    const optics::ResinSet vero = optics::vero_opaque();
    optics::ResinSet set = vero;
    for (double nm = 380; nm <= 780; nm += step_nm) set.channels.wavelengths_nm.push_back(nm);
    const auto at = [](const std::vector<double>& rgb, double nm) {
        const double green = std::clamp((nm - 465) / 85, 0.0, 1.0), red = std::clamp((nm - 550) / 60, 0.0, 1.0);
        return rgb[2] + green * (rgb[1] - rgb[2]) + red * (rgb[0] - rgb[1]);
    };
    for (std::size_t r = 0; r < set.resins.size(); ++r) {
        auto &sigma_t = set.resins[r].sigma_t_per_mm, &albedo = set.resins[r].albedo;
        sigma_t.clear(), albedo.clear();
        for (const double nm : set.channels.wavelengths_nm) {
            sigma_t.push_back(at(vero.resins[r].sigma_t_per_mm, nm));
            albedo.push_back(at(vero.resins[r].albedo, nm));
        }
    }
    return set;
}

// A whole fit of target B with noise, all threads: 0: R, G, B; 25, 5: wavelengths in steps of so many nm.
void fit_target_b(benchmark::State& state) {
    PatchTable table = testing::target('B', {"C", "M", "Y"});
    testing::measure(table, state.range(0) == 0 ? optics::vero_opaque() : spectral(static_cast<double>(state.range(0))),
                     0.005, 7);
    for (auto _ : state) benchmark::DoNotOptimize(fit_resins(table, {}));
}
BENCHMARK(fit_target_b)->Arg(0)->Arg(25)->Arg(5)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace

// SPDX-License-Identifier: GPL-3.0-or-later
//
// How long light in resin takes. Run: build/release/benchmarks/optics_benchmark
#include <array>
#include <span>
#include <vector>

#include <benchmark/benchmark.h>
#include <Eigen/Eigenvalues>

#include "base/parallel.h"
#include "optics/layered/layered_appearance.h"
#include "optics/layered/shell_appearance.h"
#include "optics/numerics/symmetric_eigen.h"

namespace {

using namespace voxtone;
using namespace voxtone::optics;

// One patch of a calibration target: 0.675 mm of cyan over deep white, 15 directions, both media new every time.
void two_layer_reflectance(benchmark::State& state) {
    const ResinSet set = vero_opaque();
    const OrdinatePlan plan = directional_plan(set.g, set.eta);
    LayerOf top{set.resins[0].medium(2), 0.675};
    Medium base = set.resins[4].medium(2);
    for (auto _ : state) {
        top.medium.sigma_a += 1e-9;
        base.sigma_a += 1e-9;
        benchmark::DoNotOptimize(reflectance_45_0(plan, std::span(&top, 1), half_space(plan, base)));
    }
}
BENCHMARK(two_layer_reflectance)->Unit(benchmark::kMicrosecond);

// The base is kept: what a search over one layer's properties pays.
void layer_over_kept_base(benchmark::State& state) {
    const ResinSet set = vero_opaque();
    const OrdinatePlan plan = directional_plan(set.g, set.eta);
    const Admittance base = half_space(plan, set.resins[4].medium(2));
    LayerOf top{set.resins[0].medium(2), 0.675};
    for (auto _ : state) {
        top.medium.sigma_a += 1e-9;
        benchmark::DoNotOptimize(reflectance_45_0(plan, std::span(&top, 1), base));
    }
}
BENCHMARK(layer_over_kept_base)->Unit(benchmark::kMicrosecond);

void modes_of_one_medium(benchmark::State& state) {
    const auto nodes = static_cast<int>(state.range(0));
    const OrdinatePlan plan = appearance_plan(0.4, 1.5, nodes / 2, nodes - nodes / 2);
    Medium medium{0.15, 7.35};
    for (auto _ : state) {
        medium.sigma_a += 1e-9;
        benchmark::DoNotOptimize(LayerModes(plan, medium));
    }
}
BENCHMARK(modes_of_one_medium)->Arg(8)->Arg(10)->Arg(15)->Arg(24)->Unit(benchmark::kMicrosecond);

/// The matrix that LayerModes takes apart: of the same size and with the same grading, K = L^T E L.
OrdinateMatrix modes_matrix(int nodes) {
    OrdinateMatrix K(nodes, nodes);
    for (int i = 0; i < nodes; ++i)
        for (int j = 0; j < nodes; ++j) {
            const double nu_i = (i + 1.0) / nodes, nu_j = (j + 1.0) / nodes;
            K(i, j) = (i == j ? 1 / (nu_i * nu_i) : 0) - 0.9 / (nodes * nu_i * nu_j);
        }
    return K;
}

void symmetric_eigen_here(benchmark::State& state) {
    OrdinateMatrix K = modes_matrix(static_cast<int>(state.range(0)));
    for (auto _ : state) {
        K(0, 0) += 1e-9;
        benchmark::DoNotOptimize(symmetric_eigen(K));
    }
}
BENCHMARK(symmetric_eigen_here)->Arg(8)->Arg(10)->Arg(15)->Arg(24)->Unit(benchmark::kMicrosecond);

// Eigen's solver on the same type, of at most max_ordinates rows: it allocates no memory either.
void symmetric_eigen_of_Eigen(benchmark::State& state) {
    OrdinateMatrix K = modes_matrix(static_cast<int>(state.range(0)));
    Eigen::SelfAdjointEigenSolver<OrdinateMatrix> solver;
    for (auto _ : state) {
        K(0, 0) += 1e-9;
        solver.compute(K);
        benchmark::DoNotOptimize(solver.eigenvectors().data());
    }
}
BENCHMARK(symmetric_eigen_of_Eigen)->Arg(8)->Arg(10)->Arg(15)->Arg(24)->Unit(benchmark::kMicrosecond);

void shell_table(benchmark::State& state) {
    const ThreadLimit limit(static_cast<std::size_t>(state.range(0)));
    const ResinSet set = vero_opaque();
    for (auto _ : state) benchmark::DoNotOptimize(ShellAppearance(set, {1.0, 4}));
}
BENCHMARK(shell_table)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

void shell_lookup(benchmark::State& state) {
    const ShellAppearance shell(vero_opaque(), {1.0, 4});
    std::array<double, 5> fractions{0.1, 0.2, 0.3, 0.1, 0.3};
    std::array<double, 3> out{};
    for (auto _ : state) {
        shell.media_relative(fractions, out);
        benchmark::DoNotOptimize(out);
    }
}
BENCHMARK(shell_lookup);

void shell_lookup_with_gradient(benchmark::State& state) {
    const ShellAppearance shell(vero_opaque(), {1.0, 4});
    std::array<double, 5> fractions{0.1, 0.2, 0.3, 0.1, 0.3};
    std::array<double, 3> out{};
    std::array<double, 15> gradient{};
    for (auto _ : state) {
        shell.media_relative(fractions, out, gradient);
        benchmark::DoNotOptimize(gradient);
    }
}
BENCHMARK(shell_lookup_with_gradient);

}  // namespace

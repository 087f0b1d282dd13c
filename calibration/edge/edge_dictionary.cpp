// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/edge/edge_dictionary.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel.h"

namespace voxtone::calibration {
namespace {

constexpr double noise_within_mm = 5;

void check_list(const std::vector<double>& list, const char* name, double least, double most) {
    if (list.empty()) throw InputError(fmt::format("{}: no value; give at least one", name));
    for (std::size_t k = 0; k < list.size(); ++k) {
        if (!(list[k] >= least && list[k] <= most))
            throw InputError(fmt::format("{}: {} is outside {} to {}", name, list[k], least, most));
        if (k > 0 && !(list[k] > list[k - 1]))
            throw InputError(fmt::format("{}: values must rise, {} comes after {}", name, list[k], list[k - 1]));
    }
}

// Standard error of the mean of the batches' profiles.
double profile_noise(const optics::EdgeCells& cells, const optics::EdgeCounts& counts, const optics::EdgeUnits& units,
                     double albedo, const optics::EdgeSheet& sheet) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(cells.size()), squares = sum;
    for (const optics::PathBatch& batch : counts) {
        const Eigen::VectorXd F = cells.profile(optics::edge_kernels(batch, units, albedo), sheet);
        sum += F;
        squares += F.cwiseAbs2();
    }
    constexpr double n = optics::edge_batches;
    const Eigen::VectorXd variance = (squares / n - (sum / n).cwiseAbs2()).cwiseMax(0) / (n - 1);
    double mean = 0, width = 0;
    for (Eigen::Index k = 1; k + 1 < cells.size(); ++k) {
        const double a = cells.edges()[static_cast<std::size_t>(k) - 1], b = cells.edges()[static_cast<std::size_t>(k)];
        if (std::abs(a + b) / 2 > noise_within_mm) continue;
        mean += variance[k] * (b - a);
        width += b - a;
    }
    return std::sqrt(mean / width);
}

}  // namespace

const std::vector<double>& paper_extinctions() {
    static const std::vector<double> list{1.0,  1.25, 1.5,  1.75, 2.0,  2.25, 2.5,  2.75, 3.0,  3.25, 3.5,  3.75, 4.0,
                                          4.5,  5.0,  5.5,  6.0,  6.5,  7.0,  7.5,  8.0,  9.0,  10.0, 11.0, 12.0, 13.0,
                                          14.0, 15.0, 16.0, 17.0, 18.0, 19.0, 20.0, 22.0, 24.0, 26.0, 28.0, 30.0};
    return list;
}

const std::vector<double>& paper_albedos() {
    static const std::vector<double> list{
        0.05,  0.1,   0.15,  0.2,   0.25,  0.3,   0.35,   0.4,    0.45,   0.5,    0.55,   0.6,     0.65,   0.7,
        0.75,  0.8,   0.85,  0.875, 0.9,   0.915, 0.92,   0.93,   0.94,   0.95,   0.96,   0.97,    0.98,   0.99,
        0.993, 0.995, 0.996, 0.997, 0.998, 0.999, 0.9991, 0.9993, 0.9995, 0.9997, 0.9999, 0.99993, 0.99999};
    return list;
}

const std::vector<double>& paper_anisotropies() {
    static const std::vector<double> list{0, 0.1, 0.2, 0.3, 0.4, 0.45, 0.5, 0.55, 0.6, 0.7, 0.8};
    return list;
}

void validate(const EdgeGrid& grid) {
    check_list(grid.thickness_mm, "--thickness", 0.05, 10);
    check_list(grid.g, "--g", -0.95, 0.95);
    check_list(grid.sigma_t, "--sigma-t", 0.01, 200);
    if (grid.paths < 1024)
        throw InputError(fmt::format("--paths: {} is too few for any result; at least 1024", grid.paths));
}

double albedo_node(std::size_t k) {
    const double u = 0.5 * (1 - std::cos(std::numbers::pi * static_cast<double>(k) / (albedo_nodes - 1)));
    return 1 - u * u;
}

Eigen::VectorXd albedo_weights(double albedo) {
    // Barycentric form for Chebyshev's points of the second kind (Berrut, Trefethen 2004, SIAM Review 46:501).
    const double u = std::sqrt(std::max(0.0, 1 - albedo));
    Eigen::VectorXd weights(albedo_nodes);
    for (std::size_t k = 0; k < albedo_nodes; ++k) {
        const double node = 0.5 * (1 - std::cos(std::numbers::pi * static_cast<double>(k) / (albedo_nodes - 1)));
        if (std::abs(u - node) < 1e-14) return Eigen::VectorXd::Unit(albedo_nodes, static_cast<Eigen::Index>(k));
        const double half = k == 0 || k + 1 == albedo_nodes ? 0.5 : 1.0;
        weights[static_cast<Eigen::Index>(k)] = (k % 2 ? -half : half) / (u - node);
    }
    return weights / weights.sum();
}

EdgeRecord edge_record(const EdgeSetup& setup, const EdgeGrid& grid, std::size_t run, const Progress* progress) {
    optics::EdgeRun traced;
    traced.assembly = setup.assembly;
    traced.light = optics::light_window(setup.assembly);
    traced.sigma_t = grid.sigma_t[run % grid.sigma_t.size()];
    traced.g = grid.g[run / grid.sigma_t.size() % grid.g.size()];
    traced.slab_mm = grid.thickness_mm[run / (grid.sigma_t.size() * grid.g.size())];
    traced.paths = grid.paths;
    traced.seed = grid.seed + 0x9E3779B97F4A7C15u * (run + 1);
    const optics::EdgeCounts counts = optics::trace_edge_paths(traced, progress);
    const optics::EdgeUnits units(traced);
    const optics::EdgeCells cells;
    EdgeRecord record;
    record.kernels.resize(albedo_nodes);
    record.noise.resize(albedo_nodes);
    parallel_for(0, albedo_nodes, 1, [&](std::size_t k) {
        record.kernels[k] = optics::edge_kernels(counts, units, albedo_node(k));
        record.noise[k] = profile_noise(cells, counts, units, albedo_node(k), setup.sheet(1));
    });
    return record;
}

}  // namespace voxtone::calibration

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The light of the step edge: against adding-doubling far from the edge, and by what must be kept.
#include "optics/edge/edge_paths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "base/parallel.h"
#include "optics/edge/edge_response.h"
#include "optics/layered/adding_doubling.h"
#include "optics/layered/directional.h"
#include "optics/monte_carlo/rough_interface.h"
#include "optics/numerics/quadrature.h"

using namespace voxtone;
using namespace voxtone::optics;

namespace {

// A slab alone on the base of the sheet: what adding-doubling knows too.
EdgeAssembly bare_slab() {
    EdgeAssembly assembly;
    assembly.gel = assembly.glass = assembly.sheet_surface = false;
    assembly.slab_roughness = 0;
    return assembly;
}

EdgeRun bare_run(double sigma_t, double g, double slab_mm, std::uint32_t paths, std::uint64_t seed) {
    EdgeRun run;
    run.assembly = bare_slab();
    run.sigma_t = sigma_t;
    run.g = g;
    run.slab_mm = slab_mm;
    run.light = light_window(run.assembly);
    run.paths = paths;
    run.seed = seed;
    return run;
}

// The reflectance factor for light from the window and a view from above, by adding-doubling.
class Exact {
public:
    explicit Exact(const DirectionWindow& window) {
        const Rule rule = gauss_legendre(3, window.least * window.least, window.most * window.most);
        for (std::size_t k = 0; k < 3; ++k) looks_[k] = std::sqrt(rule.x[k]), weights_[k] = rule.w[k] / window.share();
        grid_ = angular_grid(1.5, 16, 16, std::array{looks_[0], looks_[1], looks_[2], 1.0});
    }
    double far(double sigma_t, double albedo, double g, double slab_mm, double reflectance) const {
        const AddingDoubling solver(grid_, g, 64);
        const LayerResponse slab = solver.layer({sigma_t * (1 - albedo), sigma_t * albedo}, slab_mm);
        const Eigen::MatrixXd base = Eigen::MatrixXd::Constant(grid_.size(), grid_.size(), reflectance);
        const Eigen::MatrixXd rho = reflectance_factors(grid_, solver.over(slab, base));
        double sum = 0;
        for (std::size_t k = 0; k < 3; ++k) sum += weights_[k] * rho(grid_.find(1.0), grid_.find(looks_[k]));
        return sum;
    }

private:
    std::array<double, 3> looks_{}, weights_{};
    AngularGrid grid_;
};

struct Estimate {
    double mean = 0, error = 0;
};

// Over the independent batches.
template <class Value>
Estimate over_batches(const EdgeCounts& counts, Value&& value) {
    double sum = 0, squares = 0;
    for (std::size_t b = 0; b < edge_batches; ++b) {
        const double v = value(counts[b]);
        sum += v, squares += v * v;
    }
    const double n = edge_batches, mean = sum / n;
    return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / (n - 1))};
}

std::uint64_t sum_of(const std::vector<std::uint32_t>& counts) {
    std::uint64_t sum = 0;
    for (const std::uint32_t n : counts) sum += n;
    return sum;
}

}  // namespace

TEST_CASE("far from the edge the paths say what adding-doubling says, over white and over black", "[edge]") {
    const DirectionWindow window = light_window(bare_slab());
    const Exact exact(window);
    std::uint64_t seed = 100;
    int cases = 0, rejected = 0;
    double worst = 0, squares = 0;
    const std::array slabs{std::pair{0.0, 0.5}, std::pair{0.4, 1.0}, std::pair{0.7, 0.5}};  // g, mm
    for (const double sigma_t : {0.7, 2.0, 5.0, 12.0}) {
        // Albedo and base -> z, and z of a truth that is 2 % off, over the independent slabs.
        std::map<std::pair<double, double>, Eigen::Array2d> together;
        for (const auto& [g, slab_mm] : slabs) {
            const EdgeRun run = bare_run(sigma_t, g, slab_mm, 800000, ++seed);
            const EdgeCounts counts = trace_edge_paths(run);
            for (const double albedo : {0.7, 0.98})
                for (const double base : {0.024, 0.985}) {
                    const Estimate seen = over_batches(counts, [&](const PathBatch& batch) {
                        return far_from_edge(edge_kernels(batch, EdgeUnits(run), albedo), base);
                    });
                    const double truth = exact.far(sigma_t, albedo, g, slab_mm, base);
                    const double z = (seen.mean - truth) / seen.error, wrong = (seen.mean - 1.02 * truth) / seen.error;
                    INFO("sigma_t " << sigma_t << " g " << g << " albedo " << albedo << " base " << base << ": "
                                    << seen.mean << " +- " << seen.error << ", exact " << truth);
                    // Student's t of 31 degrees: |z| > 5 has a chance of 2e-5, of 48 cases 0.1 %.
                    CHECK(std::abs(z) < 5);
                    worst = std::max(worst, std::abs(z));
                    squares += z * z;
                    ++cases;
                    auto& sum = together.try_emplace({albedo, base}, Eigen::Array2d::Zero()).first->second;
                    sum += Eigen::Array2d(z, wrong) / std::sqrt(double(slabs.size()));
                }
        }
        for (const auto& [point, z] : together) {
            INFO("sigma_t " << sigma_t << " albedo " << point.first << " base " << point.second);
            CHECK(std::abs(z[0]) < 5);
            rejected += std::abs(z[1]) > 5;
        }
    }
    CHECK(cases == 48);
    // The mean square of Student's t of 31 degrees is 31/29; cases share paths in fours, so it may wander.
    INFO("largest |z| " << worst << ", mean square " << squares / cases << ", rejected " << rejected);
    CHECK(squares / cases < 2.5);
    // An error of 2 % is seen in all but a few of the 16.
    CHECK(rejected >= 14);
}

TEST_CASE("no light is lost or made", "[edge]") {
    EdgeRun run;
    run.light = light_window(run.assembly);
    run.sigma_t = 6;
    run.paths = 1000000;
    const EdgeCounts counts = trace_edge_paths(run);
    for (const PathBatch& batch : counts)
        for (const PathCounts* from : {&batch.camera, &batch.base, &batch.light}) {
            CHECK(from->lost == 0);
            CHECK(sum_of(from->to_light) + sum_of(from->elsewhere) + sum_of(from->to_base) == from->paths);
        }
    // Furnace: light from everywhere, a base and a resin that absorb nothing: 1 but for what is mirrored at the glass.
    run.light = {0, 1};
    const EdgeCounts furnace = trace_edge_paths(run);
    const Estimate seen = over_batches(
        furnace, [&](const PathBatch& batch) { return far_from_edge(edge_kernels(batch, EdgeUnits(run), 1), 1); });
    const double mirrored = std::pow(0.52 / 2.52, 2);
    INFO(seen.mean << " +- " << seen.error);
    CHECK(std::abs(seen.mean - (1 - mirrored)) < 6 * seen.error + 1e-12);
    CHECK(std::abs(seen.mean - 1.02 * (1 - mirrored)) > 6 * seen.error);
}

TEST_CASE("light and camera may change places", "[edge]") {
    for (const bool rough : {false, true}) {
        EdgeRun there;
        there.assembly.slab_roughness = rough ? 0.05 : 0;
        there.assembly.sheet_roughness = rough ? 0.15 : 0;
        there.sigma_t = 4;
        there.paths = 600000;
        there.camera = {std::cos(0.7), 1};
        there.light = light_window(there.assembly);
        EdgeRun back = there;
        std::swap(back.camera, back.light);
        back.seed = 2;
        const auto seen = [](const EdgeRun& run) {
            return over_batches(trace_edge_paths(run), [&](const PathBatch& batch) {
                return far_from_edge(edge_kernels(batch, EdgeUnits(run), 0.95), 0.6);
            });
        };
        const Estimate a = seen(there), b = seen(back);
        const double error = std::hypot(a.error, b.error);
        INFO(a.mean << " +- " << a.error << ", " << b.mean << " +- " << b.error);
        CHECK(std::abs(a.mean - b.mean) < 6 * error);
        CHECK(std::abs(1.02 * a.mean - b.mean) > 6 * error);
    }
}

TEST_CASE("what the base sends to the light is what the light sends to the base", "[edge]") {
    EdgeRun run;
    run.light = light_window(run.assembly);
    run.sigma_t = 4;
    run.paths = 2400000;
    const EdgeCounts counts = trace_edge_paths(run);
    const auto weighted = [](const std::vector<std::uint32_t>& by_order) {
        double sum = 0;
        for (std::size_t n = 0; n < by_order.size(); ++n) sum += order_bins().mean_power(n, 0.97) * by_order[n];
        return sum;
    };
    const Estimate counted = over_batches(counts, [&](const PathBatch& batch) {
        return weighted(batch.base.to_light) / static_cast<double>(batch.base.paths) / run.light.share();
    });
    const Estimate reversed = over_batches(
        counts, [&](const PathBatch& batch) { return edge_kernels(batch, EdgeUnits(run), 0.97).from_base; });
    const double error = std::hypot(counted.error, reversed.error);
    INFO(counted.mean << " +- " << counted.error << ", " << reversed.mean << " +- " << reversed.error);
    CHECK(std::abs(counted.mean - reversed.mean) < 5 * error);
    CHECK(std::abs(counted.mean - 1.02 * reversed.mean) > 5 * error);
}

TEST_CASE("the same counts for any number of threads", "[edge]") {
    EdgeRun run;
    run.light = light_window(run.assembly);
    run.paths = 20000;
    const auto counted = [&](std::size_t threads) {
        const ThreadLimit limit(threads);
        return trace_edge_paths(run);
    };
    const EdgeCounts one = counted(1), two = counted(2);
    for (std::size_t b = 0; b < edge_batches; ++b) {
        CHECK(one[b].camera.to_base == two[b].camera.to_base);
        CHECK(one[b].base.to_light == two[b].base.to_light);
        CHECK(one[b].light.elsewhere == two[b].light.elsewhere);
    }
}

TEST_CASE("orders and distances have their bins", "[edge]") {
    const OrderBins& orders = order_bins();
    std::size_t last = 0;
    for (std::uint32_t n = 0; n < OrderBins::most_scatterings; ++n) {
        const std::size_t bin = orders.of(n);
        REQUIRE((bin == last || bin == last + 1));
        last = bin;
    }
    CHECK(last + 1 == orders.size());
    for (const double alpha : {0.0, 0.3, 0.99, 0.99999, 1.0}) {
        // Of every bin the mean of the powers of its orders.
        for (const std::size_t bin : {0ul, 10ul, 23ul, 30ul, 60ul}) {
            double sum = 0;
            int count = 0;
            for (std::uint32_t n = 0; n < 20000; ++n)
                if (orders.of(n) == bin) sum += std::pow(alpha, n), ++count;
            REQUIRE(count > 0);
            CHECK(orders.mean_power(bin, alpha) == Approx(sum / count).epsilon(1e-9).margin(1e-300));
        }
    }
    const DistanceBins& distances = distance_bins();
    for (std::size_t k = 0; k + 1 < distances.edges().size(); ++k)
        CHECK(distances.of((distances.edges()[k] + distances.edges()[k + 1]) / 2) == k);
    CHECK(distances.of(1e9) == distances.size() - 1);
}

TEST_CASE("a rough boundary keeps the mean of a smooth one and lets light through both ways", "[edge]") {
    int through = 0;
    const int rays = 100000;
    double across = 0;
    for (int k = 0; k < rays; ++k) {
        PathRandom random(7, {{0, 0, 0}, 0, static_cast<std::uint32_t>(k)});
        std::array<double, 3> d{std::sqrt(0.5), 0, std::sqrt(0.5)};
        if (!cross_interface(d, 1.33, 1.5, 0.05, random)) continue;
        ++through;
        across += d[0];
        REQUIRE(d[2] > 0);
        REQUIRE(std::abs(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - 1) < 1e-9);
    }
    const double F = interface_reflectance(std::sqrt(0.5), 1.33, 1.5);
    CHECK(std::abs(through - rays * (1 - F)) < 6 * std::sqrt(rays * F));
    CHECK(across / through == Approx(std::sqrt(0.5) * 1.33 / 1.5).epsilon(0.005));
    CHECK(interface_reflectance(0.2, 1.5, 1.33) == 1);
    CHECK(interface_reflectance(1, 1, 1.5) == Approx(0.04));
    CHECK(interface_reflectance(1, 1.5, 1) == Approx(0.04));
}

TEST_CASE("cells are fine enough, and far from the edge they say what the base says alone", "[edge]") {
    EdgeRun run;
    run.light = light_window(run.assembly);
    run.sigma_t = 5;
    run.paths = 200000;
    const EdgeCounts counts = trace_edge_paths(run);
    for (const double albedo : {0.3, 0.95, 0.999}) {
        const EdgeKernels kernels = edge_kernels(counts, EdgeUnits(run), albedo);
        const EdgeCells cells, finer(2);
        const EdgeSheet sheet;
        std::vector<double> x;
        for (int k = -150; k < 150; ++k) x.push_back((k + 0.5) * 0.0276);
        const Eigen::VectorXd a = pixels_from_cells(cells, x, {}) * cells.profile(kernels, sheet),
                              b = pixels_from_cells(finer, x, {}) * finer.profile(kernels, sheet);
        const double step = far_from_edge(kernels, sheet.white) - far_from_edge(kernels, sheet.black);
        INFO("albedo " << albedo << " step " << step << " largest " << (a - b).cwiseAbs().maxCoeff());
        CHECK((a - b).cwiseAbs().maxCoeff() < 1.5e-3 * step);
        // A sheet of one reflectance is the same everywhere.
        const Eigen::VectorXd even = cells.profile(kernels, {0.6, 0.6});
        CHECK((even.array() - far_from_edge(kernels, 0.6)).abs().maxCoeff() < 1e-9);
    }
}

TEST_CASE("pixels see the mean of what is before them", "[edge]") {
    const EdgeCells cells;
    Eigen::VectorXd step = Eigen::VectorXd::Zero(cells.size());
    step.tail(cells.size() / 2).setOnes();
    const Eigen::MatrixXd sharp = pixels_from_cells(cells, {-0.02, -0.005, 0, 0.01, 3}, {0.04, 0, 1});
    const Eigen::VectorXd seen = sharp * step;
    CHECK(seen[0] == Approx(0).margin(1e-9));
    CHECK(seen[1] == Approx(0.375).margin(1e-9));
    CHECK(seen[2] == Approx(0.5).margin(1e-9));
    CHECK(seen[3] == Approx(0.75).margin(1e-9));
    CHECK(seen[4] == Approx(1).margin(1e-9));
    const Eigen::VectorXd soft = pixels_from_cells(cells, {-0.05, 0, 0.05}, {0.001, 0.05, 1}) * step;
    CHECK(soft[0] == Approx(0.158655).margin(2e-4));
    CHECK(soft[1] == Approx(0.5).margin(1e-4));
    CHECK(soft[2] == Approx(0.841345).margin(2e-4));
}

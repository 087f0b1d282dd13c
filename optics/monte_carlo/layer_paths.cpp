// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/monte_carlo/layer_paths.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/monte_carlo/adaptive_sampling.h"
#include "optics/monte_carlo/rough_interface.h"
#include "optics/monte_carlo/scalar_paths.h"
#include "optics/monte_carlo/voxel_walk.h"

namespace voxtone::optics {
namespace {

constexpr std::size_t rings_per_coefficient = 16;
constexpr std::uint32_t layer_paths_per_task = 4096;

enum class Exit { none, R, T, T_direct };

struct Landing {
    Exit exit = Exit::none;
    double weight = 0, r_mm = 0;
};

class LayerPaths {
public:
    explicit LayerPaths(const LayerScene& scene) : scene_(scene) {
        double z = 0;
        for (const PlainLayer& layer : scene.layers) {
            VOXTONE_EXPECT(layer.thickness_mm > 0 && std::isfinite(layer.thickness_mm));
            VOXTONE_EXPECT(layer.medium.sigma_a >= 0 && layer.medium.sigma_s >= 0);
            VOXTONE_EXPECT(layer.eta >= 1 && std::abs(layer.g.value_or(0)) < 1);
            borders_.push_back(z);
            z += layer.thickness_mm;
        }
        borders_.push_back(z);
    }

    // z points down.
    [[nodiscard]] Landing trace(PathRandom& random) const {
        std::array<double, 3> d = entering_light(2, 1.0, scene_.eta_top, random);
        double x = 0, y = 0, z = 0, weight = 1;
        std::size_t layer = 0;
        bool direct = true;
        RouletteByOrder patience;
        for (;;) {
            double depth = -std::log1p(-random.uniform());
            for (;;) {
                const Medium& medium = scene_.layers[layer].medium;
                const bool down = d[2] > 0;
                const double border = borders_[layer + (down ? 1 : 0)];
                // The distance to the border; never, for light that runs along the layer.
                const double reach = d[2] != 0 ? std::max(0.0, (border - z) / d[2]) : INFINITY;
                const double needed = medium.sigma_t() * reach;
                if (depth < needed) {
                    const double step = depth / medium.sigma_t();
                    x += step * d[0], y += step * d[1], z += step * d[2];
                    break;
                }
                if (!std::isfinite(reach)) return {};  // along a clear layer: it never comes out
                depth -= needed;
                x += reach * d[0], y += reach * d[1], z = border;
                const bool leaves = down ? layer + 1 == scene_.layers.size() : layer == 0;
                if (!leaves) {
                    const std::size_t next = layer + (down ? 1 : -1);
                    const double from = scene_.layers[layer].eta, to = scene_.layers[next].eta;
                    if (cross_interface(d, from, to, 0, random)) {
                        layer = next;
                    } else {
                        ++patience.meetings;
                        if (!patience.survives(weight, random)) return {};
                        direct = false;
                    }
                    continue;
                }
                ++patience.meetings;
                if (!patience.survives(weight, random)) return {};
                if (random.uniform() <
                    internal_reflectance(std::abs(d[2]), down ? scene_.eta_bottom : scene_.eta_top)) {
                    d[2] = -d[2];
                    direct = false;
                    continue;
                }
                if (down && scene_.backing > 0 && random.uniform() < scene_.backing) {
                    d = entering_light(2, -1.0, 1.0, random);
                    direct = false;
                    continue;
                }
                return {down ? direct ? Exit::T_direct : Exit::T : Exit::R, weight, std::hypot(x, y)};
            }
            direct = false;
            weight *= scene_.layers[layer].medium.albedo();
            if (!survives_roulette_by_weight(weight, default_roulette_weight, random)) return {};
            turn_henyey_greenstein(d, scene_.layers[layer].g.value_or(scene_.g), random);
        }
    }

private:
    const LayerScene& scene_;
    std::vector<double> borders_;
};

// Where light leaves to one side; added to by any thread.
struct Counter {
    explicit Counter(std::size_t rings) : light(rings) {}
    std::vector<std::atomic<std::uint64_t>> light;
    Tally tally;

    void add(std::size_t ring, double weight) {
        const std::uint64_t w = in_units(weight);
        light[ring].fetch_add(w, std::memory_order_relaxed);
        tally.add(w, in_units(weight * weight));
    }
    [[nodiscard]] RingLight mean(double paths) const {
        RingLight rings;
        rings.light.reserve(light.size());
        for (const auto& ring : light) rings.light.push_back(static_cast<double>(ring) * path_weight_unit / paths);
        rings.total = tally.mean(paths);
        rings.standard_error = tally.error(paths);
        return rings;
    }
};

}  // namespace

std::vector<double> ring_edges(const HankelGrid& grid) {
    std::vector<double> edges;
    const std::size_t even = rings_per_coefficient * grid.size();
    for (std::size_t i = 0; i <= even; ++i)
        edges.push_back(grid.reach_mm() * static_cast<double>(i) / static_cast<double>(even));
    for (int i = 1; i <= 48; ++i) edges.push_back(grid.reach_mm() * std::exp2(i / 16.0));
    return edges;
}

TracedProfile trace_layers(const LayerScene& scene, const HankelGrid& grid, const LayerPathOptions& options,
                           const Progress* progress) {
    VOXTONE_EXPECT(!scene.layers.empty() && std::abs(scene.g) < 1 && scene.eta_top >= 1 && scene.eta_bottom >= 1);
    VOXTONE_EXPECT(scene.backing == 0 || (scene.backing > 0 && scene.backing <= 1 && scene.eta_bottom == 1));
    VOXTONE_EXPECT(options.paths >= 2);
    const LayerPaths paths(scene);
    TracedProfile profile;
    profile.edges_mm = ring_edges(grid);
    const std::size_t rings = profile.edges_mm.size() - 1, even = rings_per_coefficient * grid.size();
    const auto ring_at = [&](double r) {
        const double in_even = r / grid.reach_mm() * static_cast<double>(even);
        if (in_even < static_cast<double>(even)) return static_cast<std::size_t>(in_even);
        const double beyond = 16 * std::log2(r / grid.reach_mm());
        return std::min(rings - 1, even + static_cast<std::size_t>(std::clamp(beyond, 0.0, 1e6)));
    };
    Counter R(rings), T(rings), T_direct(rings);
    const std::size_t tasks = (options.paths + layer_paths_per_task - 1) / layer_paths_per_task;
    parallel_for(
        0, tasks, 1,
        [&](std::size_t task) {
            const auto first = static_cast<std::uint32_t>(task) * layer_paths_per_task;
            const std::uint32_t end = first + std::min(layer_paths_per_task, options.paths - first);
            for (std::uint32_t path = first; path < end; ++path) {
                PathRandom random(options.seed, {{0, 0, 0}, 0, path});
                const Landing landing = paths.trace(random);
                if (landing.exit == Exit::none) continue;
                Counter& counter = landing.exit == Exit::R ? R : landing.exit == Exit::T ? T : T_direct;
                counter.add(ring_at(landing.r_mm), landing.weight);
            }
        },
        progress);
    profile.R = R.mean(options.paths);
    profile.T = T.mean(options.paths);
    profile.T_direct = T_direct.mean(options.paths);
    return profile;
}

}  // namespace voxtone::optics

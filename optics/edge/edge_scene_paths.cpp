// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/edge/edge_scene_paths.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/monte_carlo/rough_interface.h"
#include "optics/monte_carlo/voxel_walk.h"

namespace voxtone::optics {
namespace {

constexpr std::size_t scene_batches = 64;
constexpr double roulette_from = 0.1;

class SceneWalk {
public:
    SceneWalk(const EdgeScene& scene, double reach_mm, double step_mm, std::size_t cells)
        : scene_(scene),
          layers_(edge_layers(scene.assembly, scene.slab_mm)),
          window_(light_window(scene.assembly)),
          reach_mm_(reach_mm),
          step_mm_(step_mm),
          changes_(cells + 1, 0.0) {}

    void trace(std::uint32_t p) {
        PathRandom random(scene_.seed, {{1, 0, 0}, 7, p});
        d_ = {0, 0, 1};
        x_ = 0;
        weight_ = 1;
        met_.clear();
        std::ptrdiff_t layer = -1;  // air
        bool down = true;
        while (true) {
            const std::ptrdiff_t next = layer + (down ? 1 : -1);
            if (down && next == static_cast<std::ptrdiff_t>(layers_.size())) {
                if (!leave_base(random)) return;
                down = false;
            } else {
                const auto upper = static_cast<std::size_t>(std::max(layer, next));
                if (cross_interface(d_, index(layer), index(next), layers_[upper].roughness_above, random))
                    layer = next;
                if (layer < 0) {
                    if (d_[2] < 0 && -d_[2] >= window_.least && -d_[2] <= window_.most) deposit();
                    return;
                }
                down = d_[2] > 0;
            }
            if (!cross_layer(layers_[static_cast<std::size_t>(layer)], down, random)) return;
        }
    }

    [[nodiscard]] const std::vector<double>& changes() const { return changes_; }

private:
    [[nodiscard]] double index(std::ptrdiff_t layer) const {
        return layer < 0 ? 1.0 : layers_[static_cast<std::size_t>(layer)].index;
    }

    bool survives(PathRandom& random) {
        double left = weight_;
        for (std::size_t k = 0; k < met_.size(); ++k) left *= scene_.sheet.white;
        if (left >= roulette_from) return true;
        if (random.uniform() * roulette_from >= left) return false;
        weight_ *= roulette_from / left;
        return true;
    }

    // On to the side that it leaves by; false where roulette ends the path. The layer is entered at its upper side
    // where `down`.
    bool cross_layer(const EdgeLayer& layer, bool& down, PathRandom& random) {
        double z = down ? 0 : layer.thickness_mm;
        while (layer.slab) {
            const double step = -std::log(1 - random.uniform()) / scene_.sigma_t;
            const double z_next = z + step * d_[2];
            if (z_next <= 0 || z_next >= layer.thickness_mm) break;
            x_ += step * d_[0];
            z = z_next;
            weight_ *= scene_.albedo;
            if (!survives(random)) return false;
            turn_henyey_greenstein(d_, scene_.g, random);
        }
        down = d_[2] > 0;
        const double depth = down ? layer.thickness_mm - z : z;
        x_ += depth * d_[0] / std::max(std::abs(d_[2]), 1e-12);
        return true;
    }

    bool leave_base(PathRandom& random) {
        met_.push_back(x_);
        if (!survives(random)) return false;
        const double cosine = std::sqrt(1 - random.uniform()), sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
        const double phi = 2 * std::numbers::pi * random.uniform();
        d_ = {sine * std::cos(phi), sine * std::sin(phi), -cosine};
        // It starts at the lower side of the last layer, going up.
        return true;
    }

    void deposit() {
        std::ranges::sort(met_, std::greater<>());  // the first to cross the edge as x0 grows comes first
        double value = weight_;
        for (std::size_t k = 0; k < met_.size(); ++k) value *= scene_.sheet.black;
        changes_[0] += value;
        for (const double met : met_) {
            const double brighter = value * scene_.sheet.white / scene_.sheet.black;
            // Cells whose middle lies right of -met.
            const double cell = std::ceil((reach_mm_ - met) / step_mm_ - 0.5);
            const double last = static_cast<double>(changes_.size()) - 1;
            changes_[static_cast<std::size_t>(std::clamp(cell, 0.0, last))] += brighter - value;
            value = brighter;
        }
    }

    const EdgeScene& scene_;
    std::vector<EdgeLayer> layers_;
    DirectionWindow window_;
    double reach_mm_, step_mm_;
    std::vector<double> changes_;
    std::array<double, 3> d_{};
    double x_ = 0, weight_ = 1;
    std::vector<double> met_;
};

}  // namespace

std::vector<double> render_edge(const EdgeScene& scene, double reach_mm, double step_mm, const Progress* progress) {
    VOXTONE_EXPECT(scene.sigma_t > 0 && scene.slab_mm > 0 && scene.sheet.black > 0 && step_mm > 0);
    const auto cells = static_cast<std::size_t>(std::lround(2 * reach_mm / step_mm));
    std::vector<std::vector<double>> of_batch(scene_batches);
    parallel_for(
        0, scene_batches, 1,
        [&](std::size_t b) {
            SceneWalk walk(scene, reach_mm, step_mm, cells);
            const std::uint64_t from = std::uint64_t{scene.paths} * b / scene_batches,
                                to = std::uint64_t{scene.paths} * (b + 1) / scene_batches;
            for (std::uint64_t p = from; p < to; ++p) walk.trace(static_cast<std::uint32_t>(p));
            of_batch[b] = walk.changes();
        },
        progress);
    std::vector<double> F(cells, 0.0);
    for (const std::vector<double>& changes : of_batch)
        for (std::size_t k = 0; k < cells; ++k) F[k] += changes[k];
    const double scale = 1 / (scene.paths * light_window(scene.assembly).share());
    double running = 0;
    for (double& value : F) {
        running += value * scale;
        value = running;
    }
    return F;
}

}  // namespace voxtone::optics

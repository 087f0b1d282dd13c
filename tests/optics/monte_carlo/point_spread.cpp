// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/optics/monte_carlo/point_spread.h"

#include <algorithm>
#include <cmath>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/monte_carlo/adaptive_sampling.h"
#include "optics/monte_carlo/path_entries.h"
#include "optics/monte_carlo/path_packets.h"
#include "optics/monte_carlo/scalar_paths.h"
#include "optics/monte_carlo/voxel_walk.h"

namespace voxtone::optics::testing {
namespace {

constexpr std::uint32_t spread_paths_per_task = 1u << 12;

/// In units of path weight: sums do not depend on the order in which paths end.
struct RingSums {
    std::vector<std::uint64_t> ring;
    std::uint64_t weight = 0, square = 0;
};

/// Paths [first, end) of one channel.
class SpreadPaths : public PathSource {
public:
    SpreadPaths(const Scene& scene, const PointSpreadOptions& options, std::size_t channel, std::uint32_t first,
                std::uint32_t end)
        : scene_(scene),
          options_(options),
          channel_(channel),
          first_(first),
          path_(first),
          end_(end),
          entered_(end - first) {
        sums.ring.assign(options.edges_mm.size() - 1, 0);
    }

    bool next(PathStart& start) override {
        if (next_entry_ == entries_ && !draw()) return false;
        const std::size_t e = next_entry_++;
        const int top = scene_.volume->size()[2];
        start.voxel = {column_[e][0], column_[e][1], top - 1};
        start.at = {static_cast<float>(start.voxel[0]) + entry_.u[e], static_cast<float>(start.voxel[1]) + entry_.v[e],
                    static_cast<float>(top)};
        start.direction = {entry_.along_u[e], entry_.along_v[e], -entry_.inward[e]};
        start.depth = entry_.depth[e];
        for (std::size_t k = 0; k < 4; ++k) start.random[k] = entry_.random[k][e];
        start.tag = tag_[e];
        entered_[start.tag] = {start.at[0], start.at[1]};
        return true;
    }
    void finished(std::uint32_t tag, float weight, const std::array<float, 3>& at) override {
        if (weight == 0 || at[2] != static_cast<float>(scene_.volume->size()[2])) return;
        const double w = weight;
        const auto& pitch = scene_.volume->pitch_mm();
        const double r =
            std::hypot(double(at[0] - entered_[tag][0]) * pitch[0], double(at[1] - entered_[tag][1]) * pitch[1]);
        const auto& edges = options_.edges_mm;
        const auto above = std::upper_bound(edges.begin() + 1, edges.end() - 1, r) - edges.begin();
        sums.ring[static_cast<std::size_t>(above - 1)] += in_units(w);
        sums.weight += in_units(w);
        sums.square += in_units(w * w);
    }
    std::array<float, 3> entering_up(std::array<std::uint32_t, 4>& state) override {
        PathRandom random(state);
        const auto d = entering_light(2, 1.0, scene_.resins->eta, random);
        state = random.state();
        return {safe_component(d[0]), safe_component(d[1]), safe_component(d[2])};
    }

    RingSums sums;

private:
    /// The next paths; false where there are none. Entries are spread by a two-dimensional golden ratio sequence (R2,
    /// M. Roberts 2018).
    bool draw() {
        entries_ = next_entry_ = 0;
        for (; entries_ < Entries::most && path_ < end_; ++entries_, ++path_) {
            for (std::size_t a = 0; a < 2; ++a) {
                constexpr double step[2] = {0.7548776662466927, 0.5698402909980532};  // 1 / p, 1 / p^2, p^3 = p + 1
                const double place = std::fmod(0.5 + step[a] * path_, 1.0);
                column_[entries_][a] =
                    std::min(options_.end[a] - 1,
                             options_.first[a] + static_cast<int>(place * (options_.end[a] - options_.first[a])));
            }
            const auto counter = path_counter(
                {{column_[entries_][0], column_[entries_][1], 0}, static_cast<std::uint32_t>(channel_), path_});
            for (std::size_t k = 0; k < 4; ++k) entry_.random[k][entries_] = counter[k];
            tag_[entries_] = path_ - first_;
        }
        if (entries_ == 0) return false;
        draw_entries(options_.seed, scene_.resins->eta, entry_);
        return true;
    }

    const Scene& scene_;
    const PointSpreadOptions& options_;
    std::size_t channel_;
    std::uint32_t first_, path_, end_;
    std::vector<std::array<float, 2>> entered_;
    Entries entry_;
    std::array<std::array<int, 2>, Entries::most> column_{};
    std::array<std::uint32_t, Entries::most> tag_{};
    std::size_t entries_ = 0, next_entry_ = 0;
};

RingLight mean_of(const RingSums& sums, double paths) {
    RingLight light;
    const double one = path_weight_unit / paths;
    for (const std::uint64_t ring : sums.ring) light.light.push_back(static_cast<double>(ring) * one);
    light.total = static_cast<double>(sums.weight) * one;
    const double mean_square = static_cast<double>(sums.square) * one;
    light.standard_error = std::sqrt(std::max(0.0, mean_square - light.total * light.total) / (paths - 1));
    return light;
}

}  // namespace

std::vector<RingLight> trace_point_spread(const Scene& scene, const PointSpreadOptions& options,
                                          const Progress* progress) {
    const auto& size = scene.volume->size();
    VOXTONE_EXPECT(options.paths >= 2 && options.edges_mm.size() >= 2);
    for (std::size_t a = 0; a < 2; ++a)
        VOXTONE_EXPECT(options.first[a] >= 0 && options.first[a] < options.end[a] && options.end[a] <= size[a]);
    const std::array<int, 3> extent{options.end[0] - options.first[0], options.end[1] - options.first[1], 1};
    std::vector<Material> top(static_cast<std::size_t>(extent[0]) * static_cast<std::size_t>(extent[1]));
    scene.volume->copy_box({options.first[0], options.first[1], size[2] - 1}, extent, top);
    for (const Material material : top) VOXTONE_EXPECT(material != air);

    const PathVolume volume(scene);
    const std::size_t tasks = (options.paths + spread_paths_per_task - 1) / spread_paths_per_task;
    std::vector<RingLight> channels;
    for (std::size_t c = 0; c < scene.resins->channels.size(); ++c) {
        const PacketScene packet = packet_scene(scene, volume, c, default_roulette_weight);
        std::vector<RingSums> parts(tasks);
        parallel_for(
            0, tasks, 1,
            [&](std::size_t task) {
                const auto first = static_cast<std::uint32_t>(task) * spread_paths_per_task;
                SpreadPaths paths(scene, options, c, first, std::min(options.paths, first + spread_paths_per_task));
                trace_packets(packet, paths);
                parts[task] = std::move(paths.sums);
            },
            progress);
        RingSums all{std::vector<std::uint64_t>(options.edges_mm.size() - 1, 0)};
        for (const RingSums& part : parts) {
            for (std::size_t i = 0; i < all.ring.size(); ++i) all.ring[i] += part.ring[i];
            all.weight += part.weight;
            all.square += part.square;
        }
        channels.push_back(mean_of(all, options.paths));
    }
    return channels;
}

double radius_of_share(const RingLight& rings, std::span<const double> edges_mm, double share) {
    double within = 0;
    for (std::size_t i = 0; i < rings.light.size(); ++i) {
        const double missing = share * rings.total - within;
        if (rings.light[i] > 0 && missing <= rings.light[i])
            return edges_mm[i] + std::max(0.0, missing / rings.light[i]) * (edges_mm[i + 1] - edges_mm[i]);
        within += rings.light[i];
    }
    return edges_mm.back();
}

}  // namespace voxtone::optics::testing

// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/monte_carlo/sampled_bssrdf.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/monte_carlo/adaptive_sampling.h"
#include "optics/monte_carlo/path_entries.h"
#include "optics/monte_carlo/path_packets.h"
#include "optics/monte_carlo/scalar_paths.h"
#include "optics/monte_carlo/voxel_walk.h"
#include "optics/scene/boundary.h"

namespace voxtone::optics {
namespace {

constexpr std::size_t points_per_task = 16;

using Count = std::atomic<std::uint64_t>;
void add(Count& count, std::uint64_t more) { count.fetch_add(more, std::memory_order_relaxed); }

/// Of one channel, in units of path weight.
struct Sums {
    Sums(std::size_t pairs, std::size_t points) : pair(pairs), total(points) {}
    std::vector<Count> pair, total;
    Count weight{0}, square{0};
};

/// Which pair an offset belongs to: number in the half window, or the same seen from the other end.
class WindowIndex {
public:
    explicit WindowIndex(std::uint32_t radius) : radius_(static_cast<int>(radius)), place_(side() * side(), -1) {
        const auto offsets = half_window(radius);
        for (std::size_t i = 0; i < offsets.size(); ++i) place_[at(offsets[i].x, offsets[i].y)] = static_cast<int>(i);
    }
    /// -1: outside of the window, or the opposite offset's.
    [[nodiscard]] int find(int x, int y) const {
        return std::abs(x) > radius_ || std::abs(y) > radius_ ? -1 : place_[at(x, y)];
    }

private:
    [[nodiscard]] std::size_t side() const { return 2 * static_cast<std::size_t>(radius_) + 1; }
    [[nodiscard]] std::size_t at(int x, int y) const {
        return static_cast<std::size_t>(y + radius_) * side() + static_cast<std::size_t>(x + radius_);
    }
    int radius_;
    std::vector<int> place_;
};

/// The paths of points [first, end).
class PointPaths : public PathSource {
public:
    PointPaths(const Scene& scene, const SampledBssrdfOptions& options, const WindowIndex& window, std::size_t channel,
               std::size_t first, std::size_t end, Sums& sums)
        : scene_(scene), options_(options), window_(window), channel_(channel), point_(first), end_(end), sums_(sums) {}

    bool next(PathStart& start) override {
        if (next_entry_ == entries_ && !draw()) return false;
        const std::size_t e = next_entry_++;
        const int top = scene_.volume->size()[2];
        start.voxel[2] = top - 1;
        start.at[2] = static_cast<float>(top);
        enter(0, column(entry_point_[e]), entry_.u[e], start);
        enter(1, row(entry_point_[e]), entry_.v[e], start);
        start.direction = {entry_.along_u[e], entry_.along_v[e], -entry_.inward[e]};
        start.depth = entry_.depth[e];
        for (std::size_t k = 0; k < 4; ++k) start.random[k] = entry_.random[k][e];
        start.tag = static_cast<std::uint32_t>(entry_point_[e]);
        return true;
    }
    void finished(std::uint32_t point, float weight, const std::array<float, 3>& at) override {
        if (weight == 0 || at[2] != static_cast<float>(scene_.volume->size()[2])) return;
        const double w = weight;
        const std::uint64_t units = in_units(w);
        add(sums_.total[point], units);
        weight_ += units;
        square_ += in_units(w * w);
        const int margin = static_cast<int>(options_.margin), width = static_cast<int>(options_.width),
                  height = static_cast<int>(options_.height);
        const int x = cell(0, at[0]) - margin, y = height - 1 - (cell(1, at[1]) - margin);
        if (x < 0 || y < 0 || x >= width || y >= height) return;
        const int from_x = static_cast<int>(point % options_.width), from_y = static_cast<int>(point / options_.width);
        const auto count = [&](int offset, std::size_t origin) {
            add(sums_.pair[static_cast<std::size_t>(offset) * sums_.total.size() + origin], units);
        };
        const int there = window_.find(x - from_x, y - from_y);
        if (there >= 0) return count(there, point);
        const int back = window_.find(from_x - x, from_y - y);
        if (back >= 0) count(back, static_cast<std::size_t>(y) * options_.width + static_cast<std::size_t>(x));
    }
    std::array<float, 3> entering_up(std::array<std::uint32_t, 4>& state) override {
        PathRandom random(state);
        const auto d = entering_light(2, 1.0, scene_.resins->eta, random);
        state = random.state();
        return {safe_component(d[0]), safe_component(d[1]), safe_component(d[2])};
    }
    void add_spread() const {
        add(sums_.weight, weight_);
        add(sums_.square, square_);
    }

private:
    [[nodiscard]] int column(std::size_t point) const {
        return static_cast<int>(options_.margin + point % options_.width);
    }
    [[nodiscard]] int row(std::size_t point) const {
        return static_cast<int>(options_.margin + options_.height - 1 - point / options_.width);
    }
    /// A place in a cell, in columns and within the volume.
    void enter(std::size_t axis, int cell, float within, PathStart& start) const {
        const int last = scene_.volume->size()[axis] - 1;
        const double at = options_.first[axis] + (cell + static_cast<double>(within)) * options_.columns[axis];
        const int voxel = std::clamp(static_cast<int>(std::floor(at)), 0, last);
        start.voxel[axis] = voxel;
        start.at[axis] = static_cast<float>(voxel) + static_cast<float>(std::clamp(at - voxel, 0.0, 1.0));
    }
    [[nodiscard]] int cell(std::size_t axis, float at) const {
        return static_cast<int>(std::floor((static_cast<double>(at) - options_.first[axis]) / options_.columns[axis]));
    }
    /// The next paths of the task; false where there are none.
    bool draw() {
        entries_ = next_entry_ = 0;
        for (; entries_ < Entries::most && point_ < end_; ++entries_) {
            const auto counter =
                path_counter({{column(point_), row(point_), 0}, static_cast<std::uint32_t>(channel_), path_});
            for (std::size_t k = 0; k < 4; ++k) entry_.random[k][entries_] = counter[k];
            entry_point_[entries_] = point_;
            if (++path_ == options_.paths) {
                path_ = 0;
                ++point_;
            }
        }
        if (entries_ == 0) return false;
        draw_entries(options_.seed, scene_.resins->eta, entry_);
        return true;
    }

    const Scene& scene_;
    const SampledBssrdfOptions& options_;
    const WindowIndex& window_;
    std::size_t channel_, point_, end_;
    std::uint32_t path_ = 0;
    Sums& sums_;
    std::uint64_t weight_ = 0, square_ = 0;
    Entries entry_;
    std::array<std::size_t, Entries::most> entry_point_{};
    std::size_t entries_ = 0, next_entry_ = 0;
};

ChannelResponses mean_of(const Sums& sums, double paths, double cell_mm2) {
    ChannelResponses mean;
    const std::size_t points = sums.total.size();
    const double one = path_weight_unit / paths, of_pair = one / (2 * cell_mm2);
    mean.pairs.reserve(sums.pair.size());
    for (std::size_t i = 0; i < sums.pair.size(); ++i)
        mean.pairs.push_back(
            static_cast<float>(static_cast<double>(sums.pair[i]) * (i < points ? 2 * of_pair : of_pair)));
    for (const Count& total : sums.total) mean.total.push_back(static_cast<float>(static_cast<double>(total) * one));
    // Where no light comes out a path that did would have counted fully.
    const double mean_weight =
        sums.weight == 0 ? 1.0 : static_cast<double>(sums.square) / static_cast<double>(sums.weight);
    mean.noise = mean_weight / (2 * paths * cell_mm2);
    return mean;
}

}  // namespace

std::vector<PointOffset> half_window(std::uint32_t radius) {
    const int r = static_cast<int>(radius);
    std::vector<PointOffset> offsets;
    for (int y = 0; y <= r; ++y)
        for (int x = y == 0 ? 0 : -r; x <= r; ++x)
            if (x * x + y * y <= r * r) offsets.push_back({x, y});
    return offsets;
}

std::vector<double> light_within_window(const SampledBssrdf& responses, std::size_t channel) {
    const auto offsets = half_window(responses.radius);
    const ChannelResponses& data = responses.channels.at(channel);
    const auto width = static_cast<int>(responses.width), height = static_cast<int>(responses.height);
    std::vector<double> light(responses.points());
    for (std::size_t k = 0; k < offsets.size(); ++k)
        for (int y = 0; y + offsets[k].y < height; ++y)
            for (int x = std::max(0, -offsets[k].x); x + std::max(0, offsets[k].x) < width; ++x) {
                const auto from = static_cast<std::size_t>(y * width + x),
                           to = static_cast<std::size_t>((y + offsets[k].y) * width + x + offsets[k].x);
                const double value = data.pairs[k * responses.points() + from] * responses.cell_mm2();
                light[from] += value;
                if (k > 0) light[to] += value;
            }
    return light;
}

double share_beyond_window(const SampledBssrdf& responses, std::size_t channel) {
    const std::vector<double> within = light_within_window(responses, channel);
    const auto& total = responses.channels.at(channel).total;
    double light = 0, near = 0;
    for (std::size_t y = responses.radius; y + responses.radius < responses.height; ++y)
        for (std::size_t x = responses.radius; x + responses.radius < responses.width; ++x) {
            light += static_cast<double>(total[y * responses.width + x]);
            near += within[y * responses.width + x];
        }
    return light > 0 ? 1 - near / light : 0;
}

SampledBssrdf trace_bssrdf(const Scene& scene, const SampledBssrdfOptions& options, Progress* progress) {
    const auto& size = scene.volume->size();
    const auto& pitch = scene.volume->pitch_mm();
    VOXTONE_EXPECT(options.width >= 1 && options.height >= 1 && options.paths >= 1);
    for (std::size_t a = 0; a < 2; ++a) {
        const double cells = (a == 0 ? options.width : options.height) + 2.0 * options.margin;
        VOXTONE_EXPECT(options.columns[a] > 0 && options.first[a] >= -1);
        VOXTONE_EXPECT(options.first[a] + cells * options.columns[a] <= size[a] + 1);
    }
    const double pitch_mm = pitch[0] * options.columns[0];
    VOXTONE_EXPECT(std::abs(pitch[1] * options.columns[1] / pitch_mm - 1) <= 0.02);
    std::vector<Material> top(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]));
    scene.volume->copy_box({0, 0, size[2] - 1}, {size[0], size[1], 1}, top);
    for (const Material material : top) VOXTONE_EXPECT(material != air);

    SampledBssrdf responses{options.width, options.height, options.radius, pitch_mm, {}};
    const PathVolume volume(scene);
    const WindowIndex window(options.radius);
    const std::size_t points = responses.points(), tasks = (points + points_per_task - 1) / points_per_task;
    for (std::size_t c = 0; c < scene.resins->channels.size(); ++c) {
        const PacketScene packet = packet_scene(scene, volume, c, default_roulette_weight);
        Sums sums(half_window(options.radius).size() * points, points);
        parallel_for(
            0, tasks, 1,
            [&](std::size_t task) {
                const std::size_t first = task * points_per_task, end = std::min(points, first + points_per_task);
                PointPaths paths(scene, options, window, c, first, end, sums);
                trace_packets(packet, paths);
                paths.add_spread();
                if (progress) progress->advance(end - first);
            },
            progress);
        responses.channels.push_back(mean_of(sums, options.paths, responses.cell_mm2()));
    }
    return responses;
}

}  // namespace voxtone::optics

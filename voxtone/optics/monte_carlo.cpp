// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/optics/monte_carlo.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "voxtone/base/contracts.h"
#include "voxtone/base/error.h"
#include "voxtone/base/parallel.h"
#include "voxtone/optics/path_packets.h"
#include "voxtone/optics/plain_paths.h"

namespace voxtone::optics {
namespace {

// Weights are summed as whole numbers of 2^-32: the sum does not depend on the order, 1 is exact.
constexpr double fixed_point = 0x1p32;
constexpr std::uint32_t paths_per_task = 4096;

/// Sums over the paths of one cell and channel. Added to by any thread.
struct Tally {
    std::atomic<std::uint64_t> weight{0}, square{0};

    void add(std::uint64_t w, std::uint64_t w2) {
        weight.fetch_add(w, std::memory_order_relaxed);
        square.fetch_add(w2, std::memory_order_relaxed);
    }
    [[nodiscard]] double mean(double n) const { return static_cast<double>(weight) / fixed_point / n; }
    /// Of the mean, from the spread of the weights.
    [[nodiscard]] double error(double n) const {
        const double m = mean(n), mean_square = static_cast<double>(square) / fixed_point / n;
        return std::sqrt(std::max(0.0, mean_square - m * m) / (n - 1));
    }
    /// The same for deciding when to stop: as if one more path had counted fully, so that a dark cell is not believed
    /// to be black before it had the paths to know.
    [[nodiscard]] double careful_error(double n) const { return std::hypot(error(n), 1 / n); }
};

/// Some paths of one cell in the channel of a task.
struct Share {
    std::uint32_t value, first, count;
};

/// Work for one thread: shares [first, last) of one channel.
struct Task {
    std::size_t channel, first, last;
};

/// Everything that the paths of one prediction have in common.
struct Tracing {
    const Scene& scene;
    const Surface& surface;
    const MonteCarloOptions& options;
    PathStarts starts;
    std::size_t channels;
    std::optional<PathVolume> volume;  ///< for packets

    [[nodiscard]] PathAddress address(const Share& share, std::uint32_t path) const {
        return {surface.cells[share.value / channels].cell, static_cast<std::uint32_t>(share.value % channels),
                options.first_path + share.first + path};
    }
};

/// Gives the paths of a task to packets and adds up what comes back.
class TaskSource : public PathSource {
public:
    TaskSource(const Tracing& tracing, std::span<const Share> shares)
        : tracing_(tracing), shares_(shares), sum_(shares.size()), squares_(shares.size()) {}

    bool next(PathStart& start) override {
        if (next_entry_ == entries_ && !draw()) return false;
        const std::size_t e = next_entry_++;
        const Surface& surface = tracing_.surface;
        const Share& share = shares_[entry_share_[e]];
        const SurfaceFace& face = surface.faces[tracing_.starts.face_at(surface.cells[share.value / tracing_.channels],
                                                                        static_cast<double>(entry_.face[e]))];
        const auto axis = static_cast<std::size_t>(face.facing) / 2, along_u = (axis + 1) % 3, along_v = (axis + 2) % 3;
        const int side = static_cast<int>(face.facing) % 2;
        start.voxel = face.voxel;
        start.at[axis] = static_cast<float>(face.voxel[axis] + side);
        start.at[along_u] = static_cast<float>(face.voxel[along_u]) + entry_.u[e];
        start.at[along_v] = static_cast<float>(face.voxel[along_v]) + entry_.v[e];
        start.direction[axis] = side == 1 ? -entry_.inward[e] : entry_.inward[e];
        start.direction[along_u] = entry_.along_u[e];
        start.direction[along_v] = entry_.along_v[e];
        if (tracing_.volume->boundary()) move_to_boundary(start, e);
        start.depth = entry_.depth[e];
        for (std::size_t k = 0; k < 4; ++k) start.random[k] = entry_.random[k][e];
        start.tag = entry_share_[e];
        return true;
    }
    void finished(std::uint32_t tag, float weight) override {
        const double w = weight;
        sum_[tag] += static_cast<std::uint64_t>(w * fixed_point);
        squares_[tag] += static_cast<std::uint64_t>(w * w * fixed_point);
    }
    std::array<float, 3> entering_up(std::array<std::uint32_t, 4>& state) override {
        PathRandom random(state);
        const auto d = entering_light(2, 1.0, tracing_.scene.resins->eta, random);
        state = random.state();
        return {safe_component(d[0]), safe_component(d[1]), safe_component(d[2])};
    }
    void add_to(std::span<Tally> tallies) const {
        for (std::size_t s = 0; s < shares_.size(); ++s) tallies[shares_[s].value].add(sum_[s], squares_[s]);
    }

private:
    /// From the face of a voxel to the surface that it stands for.
    void move_to_boundary(PathStart& start, std::size_t e) const {
        const PathVolume& volume = *tracing_.volume;
        const auto& pitch = tracing_.scene.volume->pitch_mm();
        Point on_face{};
        for (std::size_t a = 0; a < 3; ++a) on_face[a] = static_cast<double>(start.at[a]) * pitch[a];
        BoundaryNormals normals;
        const Point on = volume.boundary()->nearest(on_face, normals);
        const Point d =
            entering_direction(normals, {static_cast<double>(entry_.inward[e]), static_cast<double>(entry_.along_u[e]),
                                         static_cast<double>(entry_.along_v[e])});
        for (std::size_t a = 0; a < 3; ++a) {
            const double inward = on[a] - inside_boundary_mm * normals.geometric[a];
            start.at[a] = std::clamp(static_cast<float>(inward / pitch[a] + volume.offset()), 0.0f,
                                     static_cast<float>(volume.size()[a]));
            start.voxel[a] = std::min(static_cast<int>(start.at[a]), volume.size()[a] - 1);
            start.direction[a] = safe_component(d[a]);
        }
    }

    /// The next paths of the task; false where there are none.
    bool draw() {
        entries_ = next_entry_ = 0;
        for (; entries_ < Entries::most && share_ < shares_.size(); ++entries_) {
            const auto counter = path_counter(tracing_.address(shares_[share_], path_));
            for (std::size_t k = 0; k < 4; ++k) entry_.random[k][entries_] = counter[k];
            entry_share_[entries_] = static_cast<std::uint32_t>(share_);
            if (++path_ == shares_[share_].count) {
                path_ = 0;
                ++share_;
            }
        }
        if (entries_ == 0) return false;
        draw_entries(tracing_.options.seed, tracing_.scene.resins->eta, entry_);
        return true;
    }

    const Tracing& tracing_;
    std::span<const Share> shares_;
    Entries entry_;
    std::array<std::uint32_t, Entries::most> entry_share_{};
    std::size_t entries_ = 0, next_entry_ = 0;
    std::vector<std::uint64_t> sum_, squares_;
    std::size_t share_ = 0;
    std::uint32_t path_ = 0;
};

/// The same, path by path.
void trace_plain(const Tracing& tracing, const PlainPaths& paths, std::span<const Share> shares,
                 std::span<Tally> tallies) {
    for (const Share& share : shares) {
        std::uint64_t sum = 0, squares = 0;
        for (std::uint32_t p = 0; p < share.count; ++p) {
            PathRandom random(tracing.options.seed, tracing.address(share, p));
            const double w = paths.weight(tracing.surface, tracing.starts, share.value / tracing.channels,
                                          share.value % tracing.channels, random);
            sum += static_cast<std::uint64_t>(w * fixed_point);
            squares += static_cast<std::uint64_t>(w * w * fixed_point);
        }
        tallies[share.value].add(sum, squares);
    }
}

/// The paths that are still wanted, in shares of tasks of about the same size.
std::vector<Task> make_tasks(std::size_t channels, std::vector<std::uint32_t>& drawn,
                             std::span<const std::uint32_t> wanted, std::vector<Share>& shares) {
    std::vector<Task> tasks;
    shares.clear();
    for (std::size_t c = 0; c < channels; ++c) {
        std::uint32_t room = 0;
        for (std::size_t v = c; v < drawn.size(); v += channels)
            while (drawn[v] < wanted[v]) {
                if (room == 0) {
                    tasks.push_back({c, shares.size(), shares.size()});
                    room = paths_per_task;
                }
                const std::uint32_t count = std::min(room, wanted[v] - drawn[v]);
                shares.push_back({static_cast<std::uint32_t>(v), drawn[v], count});
                tasks.back().last = shares.size();
                drawn[v] += count;
                room -= count;
            }
    }
    return tasks;
}

}  // namespace

void MonteCarloOptions::validate() const {
    if (paths < 2)
        throw InputError(
            fmt::format("{} paths per cell cannot tell how uncertain their mean is; use at least 2.", paths));
    if (!(error >= 0 && std::isfinite(error)))
        throw InputError(
            fmt::format("A standard error of {} cannot be reached; use a small positive number, 0.005 for "
                        "half a percent of white, or 0 for a fixed number of paths.",
                        error));
    const std::uint32_t most = error > 0 ? std::max(paths, max_paths) : paths;
    if (most > ~std::uint32_t{0} - first_path)
        throw InputError(
            fmt::format("Paths {} to {} + {} are asked for, but a cell has only 2^32; lower the first or "
                        "the number of paths.",
                        first_path, first_path, most));
}

MonteCarlo::MonteCarlo(const MonteCarloOptions& options) : options_(options) {
    options_.validate();
    VOXTONE_EXPECT(options.tracer == PathTracer::packets || !options.boundary);
}

Appearance MonteCarlo::predict(const Scene& scene, const Surface& surface, const Progress* progress) const {
    MonteCarloSummary summary;
    return predict(scene, surface, summary, progress);
}

Appearance MonteCarlo::predict(const Scene& scene, const Surface& surface, MonteCarloSummary& summary,
                               const Progress* progress) const {
    expect_resins_for(scene);
    const std::size_t channels = scene.resins->channels.size(), values = surface.cells.size() * channels;
    VOXTONE_EXPECT(values <= ~std::uint32_t{0});
    Tracing tracing{scene, surface, options_, PathStarts(scene, surface, options_.boundary != nullptr), channels, {}};
    std::optional<PlainPaths> plain;
    std::vector<PacketScene> packets;
    if (options_.tracer == PathTracer::plain) {
        plain.emplace(scene);
    } else {
        tracing.volume.emplace(scene, options_.boundary);
        for (std::size_t c = 0; c < channels; ++c)
            packets.push_back(packet_scene(scene, *tracing.volume, c, default_roulette_weight));
    }

    std::vector<Tally> tallies(values);
    std::vector<std::uint32_t> drawn(values, 0), wanted(values, options_.paths);
    std::vector<Share> shares;
    summary = {};
    summary.values = values;
    for (;;) {
        const std::vector<Task> tasks = make_tasks(channels, drawn, wanted, shares);
        if (tasks.empty()) break;
        parallel_for(
            0, tasks.size(), 1,
            [&](std::size_t t) {
                const auto own = std::span(shares).subspan(tasks[t].first, tasks[t].last - tasks[t].first);
                if (plain) {
                    trace_plain(tracing, *plain, own, tallies);
                } else {
                    TaskSource source(tracing, own);
                    trace_packets(packets[tasks[t].channel], source);
                    source.add_to(tallies);
                }
            },
            progress);
        for (const Share& share : shares) summary.paths += share.count;
        if (options_.error <= 0) break;
        for (std::size_t v = 0; v < values; ++v) {
            const double n = drawn[v], ratio = tallies[v].careful_error(n) / options_.error;
            if (ratio <= 1 || drawn[v] >= options_.max_paths) continue;
            // At least half as many again: the error that decides is itself uncertain.
            const double more = std::clamp(n * (ratio * ratio - 1) * 1.05, n / 2, 8 * n);
            wanted[v] =
                static_cast<std::uint32_t>(std::min(n + std::ceil(more), static_cast<double>(options_.max_paths)));
        }
    }

    Appearance appearance;
    appearance.channels = channels;
    appearance.value.resize(values);
    appearance.standard_error.resize(values);
    for (std::size_t v = 0; v < values; ++v) {
        const double n = drawn[v], error = tallies[v].error(n);
        appearance.value[v] = static_cast<float>(tallies[v].mean(n));
        appearance.standard_error[v] = static_cast<float>(error);
        summary.largest_error = std::max(summary.largest_error, error);
        if (options_.error > 0 && tallies[v].careful_error(n) > options_.error) ++summary.error_too_large;
    }
    return appearance;
}

}  // namespace voxtone::optics

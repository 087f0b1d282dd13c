// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/monte_carlo/monte_carlo.h"

#include <algorithm>
#include <vector>

#include "base/contracts.h"
#include "base/error.h"
#include "base/step_part.h"
#include "optics/monte_carlo/adaptive_sampling.h"
#include "optics/monte_carlo/directional_paths.h"
#include "optics/monte_carlo/path_entries.h"
#include "optics/monte_carlo/path_packets.h"
#include "optics/monte_carlo/scalar_paths.h"

namespace voxtone::optics {
namespace {

/// Gives the paths of some shares of one channel to packets and adds up what comes back.
class PacketPaths : public PathSource {
public:
    PacketPaths(const Scene& scene, const Surface& surface, const PathStarts& starts, const PathVolume& volume,
                const MonteCarloOptions& options, std::span<const Share> shares)
        : scene_(scene),
          surface_(surface),
          starts_(starts),
          volume_(volume),
          options_(options),
          channels_(scene.resins->channels.size()),
          own_eta_(scene.resins->has_own_eta()),
          shares_(shares),
          sum_(shares.size()),
          squares_(shares.size()) {}

    bool next(PathStart& start) override {
        if (next_entry_ == entries_ && !draw()) return false;
        const std::size_t e = next_entry_++;
        const Share& share = shares_[entry_share_[e]];
        const SurfaceFace& face =
            surface_
                .faces[starts_.face_at(surface_.cells[share.value / channels_], static_cast<double>(entry_.face[e]))];
        const auto axis = static_cast<std::size_t>(face.facing) / 2, along_u = (axis + 1) % 3, along_v = (axis + 2) % 3;
        const int side = static_cast<int>(face.facing) % 2;
        start.voxel = {face.voxel[0], face.voxel[1], face.voxel[2]};
        start.at[axis] = static_cast<float>(face.voxel[axis] + side);
        start.at[along_u] = static_cast<float>(face.voxel[along_u]) + entry_.u[e];
        start.at[along_v] = static_cast<float>(face.voxel[along_v]) + entry_.v[e];
        if (own_eta_) refract_as_there(face, e);
        start.direction[axis] = side == 1 ? -entry_.inward[e] : entry_.inward[e];
        start.direction[along_u] = entry_.along_u[e];
        start.direction[along_v] = entry_.along_v[e];
        if (volume_.boundary()) move_to_boundary(start, e);
        start.depth = entry_.depth[e];
        for (std::size_t k = 0; k < 4; ++k) start.random[k] = entry_.random[k][e];
        start.tag = entry_share_[e];
        return true;
    }
    void finished(std::uint32_t tag, float weight, const std::array<float, 3>&) override {
        const double w = weight;
        sum_[tag] += in_units(w);
        squares_[tag] += in_units(w * w);
    }
    std::array<float, 3> entering_up(std::array<std::uint32_t, 4>& state) override {
        PathRandom random(state);
        const auto d = entering_light(2, 1.0, scene_.resins->eta, random);
        state = random.state();
        return {safe_component(d[0]), safe_component(d[1]), safe_component(d[2])};
    }
    void add_to(std::span<Tally> tallies) const {
        for (std::size_t s = 0; s < shares_.size(); ++s) tallies[shares_[s].value].add(sum_[s], squares_[s]);
    }

private:
    /// The direction once more, by the index of the resin at the face.
    void refract_as_there(const SurfaceFace& face, std::size_t e) {
        const Material material = scene_.volume->at(face.voxel[0], face.voxel[1], face.voxel[2]);
        if (material == air) return;
        const double eta = scene_.resins->eta_of(scene_.resins->resins[material - 1u]);
        if (eta == scene_.resins->eta) return;
        PathRandom random({entry_.random[0][e], entry_.random[1][e], entry_.random[2][e], entry_.random[3][e]});
        const auto d = entering_light(0, 1.0, eta, random);
        entry_.inward[e] = static_cast<float>(d[0]);
        entry_.along_u[e] = safe_component(d[1]), entry_.along_v[e] = safe_component(d[2]);
        const auto state = random.state();
        for (std::size_t k = 0; k < 4; ++k) entry_.random[k][e] = state[k];
    }

    /// From the face of a voxel to the surface that it stands for.
    void move_to_boundary(PathStart& start, std::size_t e) const {
        const auto& pitch = scene_.volume->pitch_mm();
        Point on_face{};
        for (std::size_t a = 0; a < 3; ++a) on_face[a] = static_cast<double>(start.at[a]) * pitch[a];
        BoundaryNormals normals;
        const Point on = volume_.boundary()->nearest(on_face, normals);
        const Point d =
            entering_direction(normals, {static_cast<double>(entry_.inward[e]), static_cast<double>(entry_.along_u[e]),
                                         static_cast<double>(entry_.along_v[e])});
        for (std::size_t a = 0; a < 3; ++a) {
            const double inward = on[a] - inside_boundary_mm * normals.geometric[a];
            start.at[a] = std::clamp(static_cast<float>(inward / pitch[a] + volume_.offset()), 0.0f,
                                     static_cast<float>(volume_.size()[a]));
            start.voxel[a] = std::min(static_cast<int>(start.at[a]), volume_.size()[a] - 1);
            start.direction[a] = safe_component(d[a]);
        }
    }

    /// The next paths of the task; false where there are none.
    bool draw() {
        entries_ = next_entry_ = 0;
        for (; entries_ < Entries::most && share_ < shares_.size(); ++entries_) {
            const auto counter = path_counter(path_address(surface_, channels_, options_, shares_[share_], path_));
            for (std::size_t k = 0; k < 4; ++k) entry_.random[k][entries_] = counter[k];
            entry_share_[entries_] = static_cast<std::uint32_t>(share_);
            if (++path_ == shares_[share_].count) {
                path_ = 0;
                ++share_;
            }
        }
        if (entries_ == 0) return false;
        draw_entries(options_.seed, scene_.resins->eta, entry_);
        return true;
    }

    const Scene& scene_;
    const Surface& surface_;
    const PathStarts& starts_;
    const PathVolume& volume_;
    const MonteCarloOptions& options_;
    std::size_t channels_;
    bool own_eta_;
    std::span<const Share> shares_;
    Entries entry_;
    std::array<std::uint32_t, Entries::most> entry_share_{};
    std::size_t entries_ = 0, next_entry_ = 0;
    std::vector<std::uint64_t> sum_, squares_;
    std::size_t share_ = 0;
    std::uint32_t path_ = 0;
};

/// Path by path: estimate(cell, channel, random) is the weight of one.
template <class Estimate>
void trace_one_by_one(const Surface& surface, std::size_t channels, const MonteCarloOptions& options,
                      std::span<const Share> shares, std::span<Tally> tallies, Estimate&& estimate) {
    for (const Share& share : shares) {
        std::uint64_t sum = 0, squares = 0;
        for (std::uint32_t p = 0; p < share.count; ++p) {
            PathRandom random(options.seed, path_address(surface, channels, options, share, p));
            const double w = estimate(share.value / channels, share.value % channels, random);
            sum += in_units(w);
            squares += in_units(w * w);
        }
        tallies[share.value].add(sum, squares);
    }
}

void expect_flat(const Scene& scene, const Surface& surface) {
    const auto& size = scene.volume->size();
    std::vector<Material> top(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]));
    scene.volume->copy_box({0, 0, size[2] - 1}, {size[0], size[1], 1}, top);
    const bool flat = std::count(top.begin(), top.end(), air) == 0 &&
                      std::all_of(surface.faces.begin(), surface.faces.end(), [&](const SurfaceFace& face) {
                          return face.facing == Facing::plus_z && face.voxel[2] == size[2] - 1;
                      });
    if (!flat)
        throw InputError(
            "Reflectance from 45 degrees to the normal is asked for a print whose top is not flat; the geometry of "
            "calibration is that of flat patches: use the uppermost faces of a slab that fills its box.");
}

}  // namespace

MonteCarlo::MonteCarlo(const MonteCarloOptions& options) : options_(options) {
    options_.validate();
    VOXTONE_EXPECT(options.tracer == PathTracer::packets || !options.boundary);
}

TwinAppearances MonteCarlo::predict_with_twin(const Scene& scene, const Surface& surface, const ResinVolume& twin,
                                              const Progress* progress) const {
    MonteCarloOptions others = options_;
    others.seed = ~options_.seed;
    Scene other = scene;
    other.volume = &twin;
    const auto half = [&](const MonteCarlo& model, const Scene& of, double from) {
        const PartRange range(progress, from, from + 0.5);
        return model.predict(of, surface, progress);
    };
    Appearance body = half(*this, scene, 0);
    return {std::move(body), half(MonteCarlo(others), other, 0.5)};
}

Appearance MonteCarlo::predict(const Scene& scene, const Surface& surface, const Progress* progress) const {
    MonteCarloSummary summary;
    return predict(scene, surface, summary, progress);
}

Appearance MonteCarlo::predict(const Scene& scene, const Surface& surface, MonteCarloSummary& summary,
                               const Progress* progress) const {
    require_resins(scene);
    const std::size_t channels = scene.resins->channels.size();
    const PathStarts starts(scene, surface, options_.boundary != nullptr);
    if (options_.tracer == PathTracer::scalar) {
        const ScalarPaths paths(scene);
        const auto trace = [&](std::size_t, std::span<const Share> shares, std::span<Tally> tallies) {
            trace_one_by_one(surface, channels, options_, shares, tallies,
                             [&](std::size_t cell, std::size_t channel, PathRandom& random) {
                                 return paths.weight(surface, starts, cell, channel, random);
                             });
        };
        return draw_paths(surface.cells.size(), channels, options_, trace, summary, progress);
    }
    const PathVolume volume(scene, options_.boundary);
    std::vector<PacketScene> packets;
    for (std::size_t c = 0; c < channels; ++c)
        packets.push_back(packet_scene(scene, volume, c, default_roulette_weight));
    for (PacketScene& packet : packets) packet.follow_outside = options_.follow_outside;
    const auto trace = [&](std::size_t channel, std::span<const Share> shares, std::span<Tally> tallies) {
        PacketPaths paths(scene, surface, starts, volume, options_, shares);
        trace_packets(packets[channel], paths);
        paths.add_to(tallies);
    };
    return draw_paths(surface.cells.size(), channels, options_, trace, summary, progress);
}

Appearance MonteCarlo::reflectance_45_0(const Scene& scene, const Surface& surface, MonteCarloSummary& summary,
                                        const Progress* progress) const {
    require_resins(scene);
    expect_flat(scene, surface);
    const std::size_t channels = scene.resins->channels.size();
    const PathStarts starts(scene, surface);
    const DirectionalPaths paths(scene);
    const auto trace = [&](std::size_t, std::span<const Share> shares, std::span<Tally> tallies) {
        trace_one_by_one(surface, channels, options_, shares, tallies,
                         [&](std::size_t cell, std::size_t channel, PathRandom& random) {
                             return paths.estimate(surface, starts, cell, channel, random);
                         });
    };
    return draw_paths(surface.cells.size(), channels, options_, trace, summary, progress);
}

}  // namespace voxtone::optics

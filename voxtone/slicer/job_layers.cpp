// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/job_layers.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "voxtone/base/error.h"
#include "voxtone/base/parallel.h"
#include "voxtone/halftone/stack_refinement.h"
#include "voxtone/optics/resin_profile.h"
#include "voxtone/slicer/lap.h"

namespace voxtone::slicer {

namespace {

std::string channels_text(const optics::Channels& channels) {
    return channels.is_rgb() ? std::string("rgb") : fmt::format("{} wavelengths ({:g} nm)", channels.size(), fmt::join(channels.wavelengths_nm, ", "));
}

void check(const SliceOptions& options, const io::ProfileMap& map, const JobBody& body, const LoadedResins& resins) {
    if (map.target.empty()) throw InputError(fmt::format("{}: has no clusters, so there is nothing to arrange; give a map with at least one", options.profiles));
    if (map.channels != resins.set.channels)
        throw InputError(fmt::format("{}: its profiles are for {}, those of the resins {} for {}; the search compares channel by channel: make the map "
                                     "with the channels of the resins, or choose another --resins",
                                     options.profiles, channels_text(map.channels), resins.set.name, channels_text(resins.set.channels)));
    if (resins.set.resins.size() < 2)
        throw InputError("--model layered-profile: only one resin is loaded, so there are no layers to choose; load at least two, such as --load W,K");
    const Eigen::Vector3d voxels = body.placement.extent_mm.cwiseQuotient(body.grid.pitch_mm);
    if (Eigen::Index axis = 0; voxels.minCoeff(&axis) < 2)
        throw InputError(fmt::format("the model is {:.3g} voxels thick along {}: layers need at least two; print it larger (--size, --scale{})",
                                     voxels[axis], "xyz"[axis], body.is_picture ? ", --thickness" : ""));
}

/// The disc that holds the map's profiles; a finer ring than a voxel's width tells nothing.
optics::HankelGrid grid_for(const io::ProfileMap& map) {
    constexpr double least_reach_mm = 4;
    constexpr std::size_t coefficients = 48;
    double reach = least_reach_mm;
    for (const auto& target : map.target)
        for (const optics::RadialSamples& channel : target) reach = std::max(reach, channel.spacing_mm * double(channel.light.size() - 1));
    return {reach, coefficients};
}

/// Traced at a thickness in the middle of those that stacks are made of.
std::vector<halftone::StackMaterial> stack_materials(const optics::ResinSet& set, const optics::HankelGrid& grid, Progress& progress) {
    constexpr double thickness_mm = 0.3;
    progress.begin_stage("profiles of the resins", set.resins.size() * set.channels.size(), "profiles");
    std::vector<halftone::StackMaterial> materials;
    for (const optics::Resin& resin : set.resins) {
        halftone::StackMaterial& material = materials.emplace_back();
        for (std::size_t c = 0; c < set.channels.size(); ++c) {
            material.push_back(optics::resin_profile(resin.medium(c), set.g, thickness_mm, grid, {}, &progress).layer());
            progress.advance();
        }
    }
    progress.end_stage();
    return materials;
}

halftone::StackSearchOptions search_options(const SliceOptions& options, const LoadedResins& resins, std::span<const halftone::StackMaterial> materials) {
    halftone::StackSearchOptions search;
    search.thickness_mm = options.stack_thickness_mm;
    search.steps = options.stack_steps;
    search.max_blocks = options.stack_blocks;
    search.dc_weight = options.dc_weight;
    for (const ClearTop& clear : parse_clear_top(options.clear_top)) {
        const int resin = resins.set.find(clear.role);
        if (resin < 0) throw InputError(fmt::format("--clear-top {}: no resin of this role is loaded", clear.role));
        search.clear_top_mm.resize(materials.size(), 0);
        search.clear_top_mm[static_cast<std::size_t>(resin)] = clear.mm;
    }
    constexpr double endless = std::numeric_limits<double>::infinity();
    for (const optics::HomogeneousLayer& channel : materials[static_cast<std::size_t>(resins.core)])
        search.backing.push_back(channel.of_thickness(endless).R_top);
    return search;
}

std::vector<ClusterStack> search_stacks(const io::ProfileMap& map, const optics::HankelGrid& grid, std::span<const halftone::StackMaterial> materials,
                                        const halftone::StackSearchOptions& options, Progress& progress) {
    std::vector<ClusterStack> clusters(map.target.size());
    std::vector<halftone::ChannelProfiles> targets;
    for (const auto& target : map.target) {
        halftone::ChannelProfiles& profiles = targets.emplace_back();
        for (const optics::RadialSamples& channel : target) profiles.push_back(grid.from_even(channel.light, channel.spacing_mm));
    }
    progress.begin_stage("search stacks", targets.size(), "clusters");
    const halftone::StackSearch search(materials, options);
    constexpr std::size_t batch = 16;  // between two reports of progress; the result does not depend on it
    for (std::size_t first = 0; first < targets.size(); first += batch) {
        const std::size_t count = std::min(batch, targets.size() - first);
        std::vector<halftone::FoundStack> found = search.find_all(std::span(targets).subspan(first, count), &progress);
        parallel_for(0, count, 1, [&](std::size_t i) {
            ClusterStack& cluster = clusters[first + i];
            cluster.found = std::move(found[i]);
            cluster.target = std::move(targets[first + i]);
            cluster.layers = cluster.found.layers;
            cluster.distance = cluster.found.distance;
            if (!cluster.layers.empty()) {
                halftone::RefinedStack refined = halftone::refine_stack(materials, cluster.layers, cluster.target, options);
                cluster.layers = std::move(refined.layers);
                cluster.distance = refined.distance;
            }
            cluster.reached = halftone::stack_reflection(materials, cluster.layers, options.backing);
        });
        progress.advance(count);
    }
    progress.end_stage();
    for (const std::uint16_t pixel : map.cluster) clusters[pixel].share += 1.0 / double(map.cluster.size());
    return clusters;
}

}  // namespace

JobLayers::JobLayers(const SliceOptions& options, io::ProfileMap wanted, const JobBody& body, const LoadedResins& resins, Progress& progress)
    : map((check(options, wanted, body, resins), std::move(wanted))), grid(grid_for(map)) {
    // Placed first: what is wrong with the mesh is said before the search.
    const io::TexturedMesh& mesh = body.model.mesh;
    const Eigen::Vector3d extent = body.placement.extent_mm;
    halftone::StackMap stacks{map.width_px, map.height_px, map.width_mm, map.height_mm, map.cluster, halftone::MapEdge::repeat, options.layer_smoothing_mm};
    if (body.is_picture) {
        stacks.edge = halftone::MapEdge::extend;
        stacks.width_mm = extent.x(), stacks.height_mm = extent.y();
        const double stretched = extent.x() / extent.y() * map.height_mm / map.width_mm;
        if (std::abs(std::log(stretched)) > 0.02)
            warnings.push_back(fmt::format("the map of profiles ({:g} x {:g} mm) is stretched onto a picture of another shape ({:.4g} x {:.4g} mm)",
                                           map.width_mm, map.height_mm, extent.x(), extent.y()));
    }
    if (body.is_picture || options.profile_placement == "uv") {
        placement_ = MapPlacement::by_texture(mesh, stacks.width_mm, stacks.height_mm);
    } else {
        stacks.edge = halftone::MapEdge::mirror;
        placement_ = MapPlacement::by_box(mesh);
    }

    Lap lap;
    const std::vector<halftone::StackMaterial> materials = stack_materials(resins.set, grid, progress);
    materials_s = lap();
    clusters = search_stacks(map, grid, materials, search_options(options, resins, materials), progress);
    search_s = lap();

    std::vector<std::vector<halftone::StackLayer>> layers;
    for (const ClusterStack& cluster : clusters) layers.push_back(cluster.layers);
    aligned = halftone::align_stacks(layers);
    fields_.emplace(stacks, aligned);
    screen_.emplace(std::array{body.grid.pitch_mm.x(), body.grid.pitch_mm.y(), body.grid.pitch_mm.z()}, &progress);
    std::vector<io::Material> printed;
    for (std::size_t r = 0; r < resins.set.resins.size(); ++r) printed.push_back(static_cast<io::Material>(r + 1));
    wrapped_.emplace(body.surface, body.grid, *fields_, *placement_, *screen_, std::move(printed), resins.core_material());
    fit = stack_fit(body, *wrapped_, progress);
    if (fit.thin_share > 0)
        warnings.push_back(fmt::format("on {:.1f} % of the surface the body is too thin for its stack, by {:.0f} % of the stack's depth on average: layers of "
                                       "both sides meet there, and light spreads otherwise than the map asks",
                                       100 * fit.thin_share, 100 * fit.missing_mean));
}

}  // namespace voxtone::slicer

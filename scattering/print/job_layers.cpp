// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/print/job_layers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "base/warning.h"
#include "optics/profiles/saunderson.h"
#include "optics/profiles/wave_laminates.h"
#include "scattering/design/laminate_materials.h"
#include "scattering/design/shortened_laminate.h"
#include "scattering/jobs/laminate_setting.h"
#include "scattering/jobs/place_profiles.h"
#include "scattering/local_profiles/luminance_channel.h"
#include "scattering/print/cell_waves.h"
#include "scattering/print/layers_check.h"
#include "slicer/part/phase.h"

namespace voxtone::scattering {

namespace {

void check_thickness(const slicer::JobBody& body) {
    const Eigen::Vector3d voxels = body.placement.extent_mm.cwiseQuotient(body.grid.pitch_mm);
    if (Eigen::Index axis = 0; voxels.minCoeff(&axis) < 2)
        throw InputError(fmt::format(
            "the model is {:.3g} voxels thick along {}: layers need at least two; print it larger (--size, --scale{})",
            voxels[axis], "xyz"[axis], body.is_picture ? ", --thickness" : ""));
}

/// Layers that no printer makes, left over by the refinement, are dropped and alike neighbours joined.
std::vector<LaminateLayer> printable(const std::vector<LaminateLayer>& layers) {
    constexpr double least_mm = 1e-3;
    std::vector<LaminateLayer> kept;
    for (const LaminateLayer& layer : layers) {
        if (layer.thickness_mm < least_mm) continue;
        if (!kept.empty() && kept.back().material == layer.material)
            kept.back().thickness_mm += layer.thickness_mm;
        else
            kept.push_back(layer);
    }
    return kept;
}

/// Whether the map's samples are means over its pixels, as `laminate factor` writes them.
bool is_of_cells(const io::ProfileMap& map) {
    const double spacing = map.target[0][0].spacing_mm, pixel = map.width_mm / map.width_px;
    return std::abs(spacing / pixel - 1) < 1e-3;
}

/// A disc that has room for the light that laminates spread beyond the map's samples: at its rim light is folded back.
/// Waves shorter than two pixels are not in means over pixels: nothing is asked of them.
optics::HankelGrid grid_for(const io::ProfileMap& map) {
    constexpr double least_reach_mm = 10, room = 1.5;
    constexpr std::size_t least = 8, most = 64;
    const double reach_mm = std::max(least_reach_mm, room * profile_extent_mm(map));
    const auto known = static_cast<std::size_t>(std::lround(reach_mm / map.target[0][0].spacing_mm));
    return {reach_mm, is_of_cells(map) ? std::clamp(known, least, most) : most};
}

/// What laminates are made of, and what is above them.
struct Materials {
    std::vector<LaminateMaterial> materials;  ///< by resin
    double turned_back = 0;                   ///< by the surface
};

Materials computed_materials(const optics::ResinSet& set, double most_mm, const optics::HankelGrid& grid,
                             Progress& progress) {
    progress.begin_stage(name_of(slicer::Phase::profiles), set.resins.size(), "resins");
    Materials made{{}, optics::internal_diffuse_reflectance(set.eta)};
    for (std::size_t r = 0; r < set.resins.size(); ++r) {
        std::vector<double> known_mm;
        for (std::size_t c = 0; c < set.channels.size(); ++c)
            known_mm.push_back(fitting_known_mm(set.resins[r].medium(c), set.g, most_mm));
        made.materials.push_back(resin_material(set, r, known_mm, grid, {}, &progress));
        progress.advance();
    }
    progress.end_stage();
    return made;
}

/// Measured with whatever surface they had: none is added.
Materials measured_materials(const LayeredOptions& options, const io::ProfileMap& map,
                             const slicer::LoadedResins& resins, const optics::HankelGrid& grid, Progress& progress) {
    LaminateSettingOptions setting;
    setting.materials = material_files(options, resins);
    setting.reach_mm = grid.reach_mm();
    setting.coefficients = static_cast<std::uint32_t>(grid.size());
    const LaminateSetting laminates(setting);
    if (laminates.channels() != map.channels)
        throw InputError(fmt::format(
            "{}: its profiles are for {}, those of the materials ({}, ...) for {}; the search compares channel by "
            "channel",
            options.profiles, channels_in_full(map.channels), setting.materials[0],
            channels_in_full(laminates.channels())));
    return {laminates.materials(0, options.thickness_mm, {}, progress), laminates.turned_back()};
}

LaminateSearchOptions search_options(const LayeredOptions& options, const slicer::LoadedResins& resins,
                                     std::span<const LaminateMaterial> materials) {
    LaminateSearchOptions search;
    search.thickness_mm = options.thickness_mm;
    search.steps = options.steps;
    search.max_blocks = options.blocks;
    search.dc_weight = options.dc_weight;
    for (const ClearTop& clear : options.clear_top) {
        const int resin = resins.set.find(clear.role);
        search.clear_top_mm.resize(materials.size(), 0);
        search.clear_top_mm[static_cast<std::size_t>(resin)] = clear.mm;
    }
    constexpr double endless = std::numeric_limits<double>::infinity();
    for (const optics::HomogeneousLayer& channel : materials[static_cast<std::size_t>(resins.core)])
        search.backing.push_back(channel.of_thickness(endless).R_top);
    return search;
}

std::vector<ClusterLaminate> wanted_clusters(const std::string& file, const io::ProfileMap& map,
                                             const optics::HankelGrid& grid) {
    std::vector<ClusterLaminate> clusters(map.target.size());
    const bool of_cells = is_of_cells(map);
    for (std::size_t k = 0; k < clusters.size(); ++k)
        for (std::size_t c = 0; c < map.target[k].size(); ++c) try {
                const optics::RadialSamples& samples = map.target[k][c];
                optics::MeasuredSummary summary;
                std::vector<double> wanted = optics::measured_reflection(samples, grid, summary);
                const double pixel_mm = map.width_mm / map.width_px;
                clusters[k].target.push_back(
                    of_cells ? waves_behind_cells(knots_of(samples, radius_of_map(map), pixel_mm), pixel_mm, grid)
                             : std::move(wanted));
            } catch (const InputError& error) {
                throw InputError(fmt::format("{}, cluster {}, channel {}: {}", file, k, c, error.what()));
            }
    for (const std::uint16_t pixel : map.cluster) clusters[pixel].share += 1.0 / double(map.cluster.size());
    return clusters;
}

/// What a laminate on the base shows under a surface to air, in all directions.
LaminateJudge judge_of(const slicer::LoadedResins& resins, const optics::HankelGrid& grid) {
    constexpr double base_mm = 10, unit_mm = 0.001;
    const auto waves = std::make_shared<const optics::WaveLaminates>(
        resins.set, optics::LaminateEnds{.eta_top = resins.set.eta}, grid, optics::WaveOptions{4, 4, 4, unit_mm});
    return [&resins, waves](std::span<const LaminateLayer> layers) {
        std::vector<optics::ResinLayer> all;
        for (const LaminateLayer& layer : layers) all.push_back({layer.material, layer.thickness_mm});
        all.push_back({static_cast<std::size_t>(resins.core), base_mm});
        return waves->light(all).R;
    };
}

/// Designs a cluster's laminate, then leaves out what cannot be printed, and the depth that changes what is seen by
/// little. By the triangle inequality the distance grows by no more than that, also where the layered model is wrong by
/// the same before and after.
void design_cluster(ClusterLaminate& cluster, const LaminateSearch& search, std::span<const LaminateMaterial> materials,
                    const LaminateDesignOptions& options, const LaminateJudge& judge) {
    constexpr double unseen = 0.02;  // of the distance
    const auto seen = [&](std::span<const LaminateLayer> layers) {
        ChannelProfiles R = laminate_reflection(materials, layers, options.search.backing);
        for (auto& channel : R)
            for (double& value : channel) value = optics::seen_through_surface(value, options.turned_back);
        return R;
    };
    const auto distance = [&](const ChannelProfiles& a, const ChannelProfiles& b) {
        return profile_distance(a, b, options.search.weights());
    };
    LaminateDesign& design = cluster.design = design_laminate(search, materials, cluster.target, options, judge);
    design.layers = printable(design.layers);
    const ChannelProfiles whole = seen(design.layers);
    design.layers =
        shortened_laminate(design.layers, unseen * cluster.distance(),
                           [&](std::span<const LaminateLayer> layers) { return distance(seen(layers), whole); });
    design.modelled = seen(design.layers);
    design.modelled_distance = distance(design.modelled, cluster.target);
    if (!judge) return;
    design.judged = judge(design.layers);
    design.judged_distance = distance(design.judged, cluster.target);
}

void search_laminates(const LayeredOptions& options, const slicer::LoadedResins& resins, const optics::HankelGrid& grid,
                      std::vector<ClusterLaminate>& clusters, const Materials& made, Progress& progress) {
    const std::span<const LaminateMaterial> materials = made.materials;
    LaminateDesignOptions design;
    design.search = search_options(options, resins, materials);
    design.turned_back = made.turned_back;
    const int rounds = correcting_rounds(options);
    design.rounds = std::max(1, rounds);
    const LaminateJudge judge = rounds > 0 ? judge_of(resins, grid) : LaminateJudge();
    progress.begin_stage(name_of(slicer::Phase::search), clusters.size(), "clusters");
    const LaminateSearch search(materials, design.search);
    parallel_for(
        0, clusters.size(), 1,
        [&](std::size_t k) {
            design_cluster(clusters[k], search, materials, design, judge);
            progress.advance();
        },
        &progress);
    progress.end_stage();
}

PlacedMap place_map(const LayeredOptions& options, const io::ProfileMap& map, const slicer::JobBody& body) {
    const io::TexturedMesh& mesh = body.model.mesh;
    LaminateMap laminates{map.width_px, map.height_px,   map.width_mm,        map.height_mm,
                          map.cluster,  MapEdge::repeat, options.smoothing_mm};
    if (body.is_picture) {
        const Eigen::Vector3d extent = body.placement.extent_mm;
        laminates.edge = MapEdge::extend;
        laminates.width_mm = extent.x(), laminates.height_mm = extent.y();
        std::string stretched;
        if (std::abs(std::log(extent.x() / extent.y() * map.height_mm / map.width_mm)) > 0.02)
            stretched = fmt::format(
                "the map of profiles ({:g} x {:g} mm) is stretched onto a picture of another shape ({:.4g} x {:.4g} "
                "mm)",
                map.width_mm, map.height_mm, extent.x(), extent.y());
        return {laminates, MapPlacement::by_texture(mesh, laminates.width_mm, laminates.height_mm), stretched};
    }
    if (options.placement == ProfilePlacement::uv)
        return {laminates, MapPlacement::by_texture(mesh, laminates.width_mm, laminates.height_mm), ""};
    laminates.edge = MapEdge::mirror;
    return {laminates, MapPlacement::by_box(mesh), ""};
}

std::vector<std::vector<LaminateLayer>> layers_of(const std::vector<ClusterLaminate>& clusters) {
    std::vector<std::vector<LaminateLayer>> layers;
    for (const ClusterLaminate& cluster : clusters) layers.push_back(cluster.design.layers);
    return layers;
}

std::vector<io::Material> printed_materials(const slicer::LoadedResins& resins) {
    std::vector<io::Material> printed;
    for (std::size_t r = 0; r < resins.set.resins.size(); ++r) printed.push_back(static_cast<io::Material>(r + 1));
    return printed;
}

std::vector<std::string> warnings_of(const PlacedMap& placed, const LaminateFit& fit) {
    std::vector<std::string> warnings;
    if (!placed.stretched.empty()) warnings.push_back(named_warning("stretched-map", placed.stretched));
    if (fit.thin_share > 0)
        warnings.push_back(named_warning(
            "thin-laminate",
            fmt::format(
                "on {:.1f} % of the surface the body is too thin for its laminate, by {:.0f} % of the laminate's "
                "depth on average: layers of "
                "both sides meet there, and light spreads otherwise than the map asks",
                100 * fit.thin_share, 100 * fit.missing_mean)));
    return warnings;
}

}  // namespace

int correcting_rounds(const LayeredOptions& options) {
    return options.materials.empty() ? options.rounds.value_or(1) : 0;
}

double profile_extent_mm(const io::ProfileMap& map) {
    double extent = 0;
    for (const auto& target : map.target)
        for (const optics::RadialSamples& channel : target)
            extent = std::max(extent, channel.spacing_mm * double(channel.light.size() - 1));
    return extent;
}

JobLayers::JobLayers(DesignedLaminates designed, const slicer::JobBody& body, const slicer::LoadedResins& resins,
                     Progress& progress)
    : map(std::move(designed.map)),
      grid(designed.grid),
      clusters(std::move(designed.clusters)),
      measured(designed.measured),
      materials_s(designed.materials_s),
      search_s(designed.search_s),
      aligned(align_laminates(layers_of(clusters))),
      placement_(std::move(designed.placed.placement)),
      fields_(designed.placed.laminates, aligned),
      screen_(std::array{body.grid.pitch_mm.x(), body.grid.pitch_mm.y(), body.grid.pitch_mm.z()}, &progress),
      wrapped_(*body.surface, body.grid, fields_, placement_, screen_, printed_materials(resins),
               resins.core_material()) {
    fit =
        laminate_fit(body.surface, body.grid,
                     body.is_picture ? std::optional(body.placement.extent_mm.z()) : std::nullopt, wrapped_, progress);
    warnings = warnings_of(designed.placed, fit);
}

std::unique_ptr<const JobLayers> arrange_layers(const LayeredOptions& options, io::ProfileMap map,
                                                const slicer::JobBody& body, const slicer::LoadedResins& resins,
                                                Progress& progress) {
    check_thickness(body);
    if (options.materials.empty()) map = asked_of(resins.set.channels, std::move(map));
    // What is wrong with map and mesh is said before the search.
    const optics::HankelGrid grid = grid_for(map);
    std::vector<ClusterLaminate> clusters = wanted_clusters(options.profiles, map, grid);
    PlacedMap placed = place_map(options, map, body);

    Stopwatch watch;
    const Materials materials = options.materials.empty()
                                    ? computed_materials(resins.set, options.thickness_mm, grid, progress)
                                    : measured_materials(options, map, resins, grid, progress);
    const double materials_s = watch.lap();
    search_laminates(options, resins, grid, clusters, materials, progress);
    return std::make_unique<const JobLayers>(
        DesignedLaminates{std::move(map), grid, std::move(clusters), std::move(placed), !options.materials.empty(),
                          materials_s, watch.lap()},
        body, resins, progress);
}

}  // namespace voxtone::scattering

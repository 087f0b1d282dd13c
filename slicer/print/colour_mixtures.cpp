// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/colour_mixtures.h"

#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "halftone/separation/translucency.h"
#include "slicer/layers/depth_zones.h"

namespace voxtone::slicer {

namespace {

/// The separation's, from the surface to the shell's depth.
MixtureBelow separated(const SurfaceColour& target, const halftone::Separation& separation) {
    return [&](std::uint32_t triangle, const Eigen::Vector2f& uv, double, double weight, std::span<double> sum) {
        std::array<float, halftone::max_resins> share;
        separation.shares(target.at(triangle, uv.x(), uv.y()), share.data());
        double whole = 0;
        for (std::size_t r = 0; r < sum.size(); ++r) whole += double(share[r]);
        for (std::size_t r = 0; r < sum.size(); ++r) sum[r] += weight * double(share[r]) / whole;
    };
}

/// Surface first, and core below the skin.
MixtureBelow rearranged(const SurfaceColour& target, const halftone::MinimalDepthSeparation& recipes,
                        std::size_t core) {
    return [&, core](std::uint32_t triangle, const Eigen::Vector2f& uv, double depth_mm, double weight,
                     std::span<double> sum) {
        const std::size_t layer = recipes.layers().layer_of(depth_mm);
        if (layer == recipes.layers().size()) {
            sum[core] += weight;
            return;
        }
        std::vector<float> fractions(recipes.layers().size() * recipes.resins());
        recipes.separate(recipes.into_gamut(target.at(triangle, uv.x(), uv.y())), fractions);
        for (std::size_t r = 0; r < sum.size(); ++r) sum[r] += weight * double(fractions[layer * recipes.resins() + r]);
    };
}

/// The same where alpha asks for clear resin: so much less of all others, so much deeper, core below the shell.
MixtureBelow thinned(const SurfaceColour& target, const halftone::Translucency& translucency, double shell_mm,
                     std::size_t core, MixtureBelow coloured) {
    return [&target, &translucency, shell_mm, core, coloured = std::move(coloured)](
               std::uint32_t triangle, const Eigen::Vector2f& uv, double depth_mm, double weight,
               std::span<double> sum) {
        const double kept =
            double(translucency.kept(target.at(triangle, uv.x(), uv.y()), target.alpha_at(triangle, uv.x(), uv.y())));
        sum[std::size_t(translucency.clear())] += weight * (1 - kept);
        if (depth_mm * kept > shell_mm)
            sum[core] += weight * kept;
        else
            coloured(triangle, uv, depth_mm * kept, weight * kept, sum);
    };
}

}  // namespace

ResinVolumes colour_volumes(const OpenedJob& job, const JobBody& body, const LayerRange& range,
                            const ColourRecipes& made_with, const Progress& progress) {
    const Eigen::Vector3d& pitch_mm = body.grid.pitch_mm;
    // Voxels look colours up at their centres, the loop has one of each cell.
    const SurfaceColour target(
        body.model.mesh, made_with.recipes ? job.options.prediction.cell_mm : std::sqrt(pitch_mm.x() * pitch_mm.y()));
    VolumeQuery query;
    query.layers = range;
    query.keep_thin = job.options.keep_thin;
    query.shell_mm = looked_through_mm(job.options, body);
    query.resins = job.resins.set.resins.size();
    query.core = static_cast<std::size_t>(job.resins.core);
    query.mixture = made_with.recipes ? rearranged(target, *made_with.recipes, query.core)
                                      : separated(target, made_with.separation);
    std::optional<halftone::Translucency> translucency;
    if (target.has_alpha()) {
        translucency.emplace(made_with.appearance, made_with.separation, job.resins.set.find("T"));
        query.mixture = thinned(target, *translucency, made_with.appearance.geometry().shell_mm, query.core,
                                std::move(query.mixture));
    }
    const DepthZones zones =
        zones_of(shell_geometry(job.options.colour, job.resins, pitch_mm, slab_under_colour(job.options, body)));
    if (zones.any())
        query.mixture = [zones, coloured = std::move(query.mixture)](std::uint32_t triangle, const Eigen::Vector2f& uv,
                                                                     double depth_mm, double weight,
                                                                     std::span<double> sum) {
            if (const int resin = zones.resin_at(static_cast<float>(depth_mm)); resin >= 0)
                sum[static_cast<std::size_t>(resin)] += weight;
            else
                coloured(triangle, uv, depth_mm - zones.colour_from_mm, weight, sum);
        };
    return resin_volumes(body, query, progress);
}

}  // namespace voxtone::slicer

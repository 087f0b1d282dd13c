// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/predict/resin_response.h"

#include <algorithm>
#include <cmath>

#include "slicer/look/prediction_files.h"
#include "slicer/look/surface_prediction.h"
#include "slicer/options/model_choice.h"
#include "slicer/part/backing_sheet.h"

namespace voxtone::slicer {

namespace {

constexpr double step = 0.1;
// A channel: 0.5 % of a region, of which there are as many as calibration/compare/print_regions.h takes.
constexpr double paths_of_region = 4e4, region_mm2 = 0.7 * 0.7, most_regions = 200;
constexpr double least_paths = 4, most_paths = 1024;
constexpr std::uint64_t seed_of_reference = 0x6a09e667f3bcc909;  // sqrt(2) - 1: nobody's choice

enum class Part { extinction, absorption };

optics::ResinSet changed(optics::ResinSet set, std::size_t resin, Part part) {
    optics::Resin& r = set.resins[resin];
    for (std::size_t c = 0; c < r.albedo.size(); ++c) {
        if (part == Part::extinction)
            r.sigma_t_per_mm[c] *= std::exp(step);
        else if (r.albedo[c] > 0 && r.albedo[c] < 1)
            r.albedo[c] = 1 / (1 + (1 - r.albedo[c]) / r.albedo[c] * std::exp(step));
    }
    return set;
}

optics::Scene scene_of(const PredictedStack& seen, const PredictFigures& figures, const optics::ResinSet& resins) {
    const auto& voxels = seen.stack.volume.size();
    const auto& pitch_mm = seen.stack.volume.pitch_mm();
    return {.volume = &seen.stack.volume,
            .resins = &resins,
            .backing = figures.backing.kind,
            .sheet = sheet_under(figures.backing, {voxels[0] * pitch_mm[0], voxels[1] * pitch_mm[1]}, resins.channels),
            .spread_mm = seen.stack.spread_mm};
}

/// In the light of the print's own road, on the backing that it lies on.
std::unique_ptr<const optics::AppearanceModel> model_for(const PredictFigures& figures, PredictionModel model,
                                                         ModelOptions quality) {
    quality.from_behind = figures.from_behind;
    if (!figures.from_behind) set_depth_of_cells(quality, figures.backing.kind);
    return make_model(model, quality);
}

}  // namespace

ResinResponse resin_response(const PredictedStack& seen, const PredictFigures& figures, ResinParts parts,
                             Progress& progress) {
    const optics::Surface& surface = seen.prediction.surface;
    const optics::ResinSet& set = seen.stack.resins;
    const auto size = picture_cells(seen.stack.volume, surface.cell_voxels);
    ResinResponse response;
    response.columns = (size[0] + ResinResponse::block - 1) / ResinResponse::block;
    response.rows = (size[1] + ResinResponse::block - 1) / ResinResponse::block;
    response.channels = set.channels.size(), response.resins = set.resins.size();
    const std::size_t channels = response.channels, resins = response.resins;
    const std::size_t blocks = std::size_t(response.columns) * std::size_t(response.rows);
    std::vector<std::size_t> block_of(surface.cells.size());
    std::vector<float> share(blocks, 0.0f);
    for (std::size_t i = 0; i < block_of.size(); ++i) {
        const auto& at = surface.cells[i].cell;
        block_of[i] = std::size_t((size[1] - 1 - at[1]) / ResinResponse::block) * std::size_t(response.columns) +
                      std::size_t(at[0] / ResinResponse::block);
        share[block_of[i]] += 1;
    }
    for (float& cells : share) cells = 1 / std::max(cells, 1.0f);
    const auto held = seen.stack.volume.count();
    Progress silent;
    const auto predicted = [&](const optics::ResinSet& resins_as) {
        ModelOptions quality;
        quality.viewing_cells = true;
        quality.sweeps = 1;
        quality.memory_bytes = memory_budget(0);
        const optics::Appearance seen_as = model_for(figures, PredictionModel::transport, quality)
                                               ->predict(scene_of(seen, figures, resins_as), surface, &silent);
        std::vector<float> mean(blocks * channels, 0.0f);
        for (std::size_t i = 0; i < block_of.size(); ++i)
            for (std::size_t c = 0; c < channels; ++c)
                mean[block_of[i] * channels + c] += share[block_of[i]] * seen_as.value[i * channels + c];
        return mean;
    };
    const bool both = parts == ResinParts::extinction_and_absorption;
    progress.begin_stage("what resins change", (both ? 2 : 1) * resins + 1, "predictions");
    response.value = predicted(set);
    progress.advance();
    for (const Part part : {Part::extinction, Part::absorption}) {
        if (part == Part::absorption && !both) continue;
        std::vector<float>& by = part == Part::extinction ? response.by_extinction : response.by_absorption;
        by.assign(blocks * resins * channels, 0.0f);
        for (std::size_t r = 0; r < resins; ++r) {
            progress.check_cancelled();
            if (held[r + 1] > 0) {
                const std::vector<float> moved = predicted(changed(set, r, part));
                for (std::size_t block = 0; block < blocks; ++block)
                    for (std::size_t c = 0; c < channels; ++c)
                        by[(block * resins + r) * channels + c] =
                            float((moved[block * channels + c] - response.value[block * channels + c]) / step);
            }
            progress.advance();
        }
    }
    progress.end_stage();
    return response;
}

std::vector<Eigen::Vector3f> colours_by_paths(const PredictedStack& seen, const PredictFigures& figures,
                                              Progress& progress) {
    const std::vector<optics::SurfaceCell>& cells = seen.prediction.surface.cells;
    double area_mm2 = 0;
    for (const optics::SurfaceCell& cell : cells) area_mm2 += cell.area_mm2;
    const double paths = paths_of_region * std::min(area_mm2 / region_mm2, most_regions);
    ModelOptions quality;
    quality.paths = std::uint32_t(std::clamp(std::ceil(paths / double(cells.size())), least_paths, most_paths));
    quality.seed = seed_of_reference;
    progress.begin_stage("light paths", 0);
    std::vector<Eigen::Vector3f> rgb =
        predict_surface(scene_of(seen, figures, seen.stack.resins), seen.prediction.surface,
                        *model_for(figures, PredictionModel::monte_carlo, quality), -1, progress)
            .rgb;
    progress.end_stage();
    return rgb;
}

}  // namespace voxtone::slicer

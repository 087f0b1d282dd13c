// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/job_prediction.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "halftone/loop/misfit.h"
#include "halftone/loop/paper.h"
#include "optics/colour/colour.h"
#include "slicer/look/coarse_cells.h"
#include "slicer/options/model_choice.h"
#include "slicer/part/phase.h"
#include "slicer/surface/target_cells.h"

namespace voxtone::slicer {

JobVolume::JobVolume(const VoxelGrid& grid, std::uint64_t memory_bytes) {
    volume_.emplace(LayerWindow{{}, grid.size}, std::array{grid.pitch_mm.x(), grid.pitch_mm.y(), grid.pitch_mm.z()},
                    LayerVolume::same_materials(), memory_bytes);
}

void JobVolume::add(int k, const io::LayerRuns& layer) {
    if (given_up_) return;
    try {
        volume_->add(k, layer);
    } catch (const ResourceError& error) {
        const std::scoped_lock lock(mutex_);
        given_up_ = true;
        why_not_ = error.what();
    }
}

std::optional<optics::ResinVolume> JobVolume::finish() {
    std::optional<optics::ResinVolume> volume;
    if (!given_up_) volume = volume_->finish();
    volume_.reset();
    return volume;
}

namespace {

constexpr double flare = 0.01;

/// CIEDE2000 of two colours in CIELAB, each with the light of a room over it.
double difference_in_a_room(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    const auto seen = [](const Eigen::Vector3d& lab) -> Eigen::Vector3d {
        return optics::lab_from_linear_srgb(
            ((optics::linear_srgb_from_lab(lab).array() + flare) / (1 + flare)).matrix());
    };
    return optics::ciede2000(seen(a), seen(b));
}

std::vector<Eigen::Vector3f> in_a_room(std::vector<Eigen::Vector3f> rgb) {
    for (Eigen::Vector3f& one : rgb) one = (one.array() + float(flare)) / (1 + float(flare));
    return rgb;
}

}  // namespace

SeenPrint seen_from(const JobPrediction& p, double viewing_distance_mm, bool adapts,
                    std::shared_ptr<const halftone::SeenTarget> asked) {
    const optics::Surface& surface = p.predicted.surface;
    if (!asked) asked = halftone::see_target(surface, p.target, viewing_distance_mm);
    SeenPrint seen;
    if (adapts) seen.paper = halftone::paper_level(surface, p.target, p.predicted.rgb);
    std::vector<Eigen::Vector3f> print = p.predicted.rgb;
    for (Eigen::Vector3f& rgb : print) rgb /= seen.paper;
    auto [target_views, print_views] = asked->eye.views(p.target, print);
    const std::vector<Eigen::Vector3f>&near_target = target_views.smoothed, &near = print_views.smoothed;
    seen.difference.resize(print.size());
    seen.target.resize(print.size()), seen.print.resize(print.size());
    parallel_for(0, print.size(), 1024, [&](std::size_t i) {
        const Eigen::Vector3d wanted = target_views.lab[i].cast<double>(), got = print_views.lab[i].cast<double>();
        seen.difference[i] = difference_in_a_room(wanted, got);
        seen.target[i] = optics::linear_srgb_from_lab(wanted).cast<float>();
        seen.print[i] = optics::linear_srgb_from_lab(got).cast<float>();
    });
    seen.regions = asked->regions;
    seen.looks = halftone::look_at(seen.regions, surface, near_target, near);
    for (halftone::RegionLook& look : seen.looks) look.difference = difference_in_a_room(look.asked, look.lab);
    const halftone::CellNeighbours cells(surface);
    for (const halftone::ColourRegion& region : seen.regions)
        seen.rims.push_back(
            region.kind == halftone::RegionKind::solid ? halftone::rim_chroma(region, cells, near_target, near) : 0);
    const halftone::EyeFilter wide(surface, halftone::wider * viewing_distance_mm, halftone::EyeSurround::none,
                                   halftone::OpponentSpace::cielab, halftone::EyeParts::narrowest);
    seen.fine = halftone::fine_contrast(near_target, near, wide);
    seen.texture =
        look_at_texture(surface, in_a_room(near_target), in_a_room(near), seen.regions, wide, viewing_distance_mm);
    return seen;
}

JobPrediction prediction_of_loop(const JobLoop& loop, optics::ResinVolume volume) {
    const ViewedCells& cells = loop.cells->seen;
    JobPrediction job;
    const std::vector<Eigen::Vector3f>& last_look = loop.result.last_look;
    job.model = last_look.empty() ? loop.model + ", in the loop's cells" : loop.model;
    job.volume = std::move(volume);
    job.predicted.surface = cells.surface;
    job.predicted.channels = 3;
    job.predicted.rgb = last_look.empty() ? loop.result.state.shown : last_look;
    for (const Eigen::Vector3f& rgb : job.predicted.rgb)
        job.predicted.value.insert(job.predicted.value.end(), rgb.data(), rgb.data() + 3);
    job.target = cells.target;
    job.cell_um = cells.cell_um;
    job.open_loop = loop.result.state.open;
    job.difference = colour_differences(job.target, job.predicted.rgb);
    job.summary = summarize_by_area(job.predicted.surface, job.difference);
    return job;
}

JobPrediction predict_print(const ResolvedJob& job, PredictionModel model, const JobBody& body,
                            const LoadedResins& resins, optics::ResinVolume volume, const ViewedCells* known,
                            const WhiteTwin& white, Progress& progress) {
    const Stopwatch watch;
    JobPrediction prediction;
    prediction.model = name_of(model);
    prediction.channels = resins.set.channels;
    prediction.volume = std::move(volume);
    progress.begin_stage(name_of(Phase::predict), 0);
    const optics::Scene scene = scene_of(prediction.volume, resins, body, job.picture.backing);
    ViewedCells cells = known ? *known : find_viewed_cells(scene, body, job.prediction.cell_mm, progress);
    prediction.target = std::move(cells.target);
    prediction.cell_um = cells.cell_um;
    std::optional<MeshBoundary> boundary;
    const bool is_bare = job.colour.clear_over_mm() == 0;  // else it ends where the colours are
    if (model == PredictionModel::monte_carlo && !body.is_picture && body.relief.empty() && is_bare)
        boundary = boundary_of(body);
    std::optional<CoarseCells> coarse;
    if (model == PredictionModel::transport) coarse = coarse_cells(scene.volume->pitch_mm(), job.prediction.cell_mm);
    const std::uint64_t memory = job.prediction.memory_bytes;
    ModelOptions quality;
    quality.cell_mm = coarse ? eye_cell_mm : job.prediction.cell_mm;
    quality.viewing_cells = coarse.has_value();
    quality.memory_bytes = memory - std::min(memory, std::uint64_t{2 * prediction.volume.memory_bytes()});
    if (!job.picture.is_lit_from_behind()) set_depth_of_cells(quality, scene.backing);
    quality.boundary = boundary ? &*boundary : nullptr;
    quality.seed = job.seed;
    quality.from_behind = job.picture.is_lit_from_behind();
    const auto seer = make_model(model, quality);
    const int white_resin = resins.set.find(job.picture.is_lit_from_behind() ? "T" : "W");
    const auto predicted_on = [&](optics::Surface surface, const WhiteTwin& twin) {
        return predict_surface(scene, std::move(surface), *seer, white_resin >= 0 ? white_resin : resins.core, progress,
                               twin);
    };
    if (coarse) {
        optics::Surface eye = optics::find_surface(scene, coarse->eye, seen_part(body), &progress);
        prediction.predicted =
            averaged(predicted_on(std::move(eye), {white.print}), std::move(cells.surface), seen_part(body));
    } else {
        // A loop that was read back saw the body as it was made ready then: in these cells, or its white is of no use.
        const bool fits = white.seen && white.seen->size() == cells.surface.cells.size() * resins.set.channels.size();
        prediction.predicted = predicted_on(std::move(cells.surface), {white.print, fits ? white.seen : nullptr});
    }
    prediction.difference = colour_differences(prediction.target, prediction.predicted.rgb);
    prediction.summary = summarize_by_area(prediction.predicted.surface, prediction.difference);
    progress.end_stage();
    prediction.seconds = watch.total();
    return prediction;
}

}  // namespace voxtone::slicer

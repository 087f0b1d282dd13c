// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/job/job_prediction.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "voxtone/base/error.h"
#include "voxtone/base/stopwatch.h"
#include "voxtone/slicer/options/model_choice.h"
#include "voxtone/slicer/predict/stack_volume.h"
#include "voxtone/slicer/surface/target_cells.h"

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

PredictionPlan plan_prediction(const SliceOptions& options, const JobBody& body, bool all_layers, bool looped) {
    if (!options.report || options.predict == "none") return {};
    if (!all_layers) return {"", "Only a part of the layers was made: a part is not predicted."};
    if (options.predict != "auto") return {options.predict, ""};
    const double area_mm2 = coloured_area_mm2(*body.surface);
    if (area_mm2 <= 100 * auto_prediction_cm2) return {model_names()[0], ""};
    if (looped) return {loop_prediction, ""};
    return {"", fmt::format("The coloured surface has {:.0f} cm2; more than {:g} cm2 are not predicted without being "
                            "asked: --predict {}.",
                            area_mm2 / 100, auto_prediction_cm2, model_names()[0])};
}

JobPrediction prediction_of_loop(const JobLoop& loop, optics::ResinVolume volume) {
    JobPrediction job;
    job.model = loop.model + ", in the loop's cells";
    job.volume = std::move(volume);
    job.predicted.surface = loop.surface;
    job.predicted.channels = 3;
    job.predicted.rgb = loop.result.state.shown;
    for (const Eigen::Vector3f& rgb : job.predicted.rgb)
        job.predicted.value.insert(job.predicted.value.end(), rgb.data(), rgb.data() + 3);
    job.target = loop.target;
    job.cell_um = loop.cell_um;
    job.open_loop = loop.result.state.open;
    job.difference = colour_differences(job.target, job.predicted.rgb);
    job.summary = summarize_by_area(job.predicted.surface, job.difference);
    return job;
}

JobPrediction predict_job(const SliceOptions& options, const std::string& model, const JobBody& body,
                          const LoadedResins& resins, optics::ResinVolume volume, Progress& progress) {
    const Stopwatch watch;
    JobPrediction job;
    job.model = model;
    job.volume = std::move(volume);
    progress.begin_stage("predict", 0);
    const optics::Scene scene{.volume = &job.volume,
                              .resins = &resins.set,
                              .backing = body.is_picture ? parse_backing(options.backing) : optics::Backing::none};
    const auto cell = optics::cell_voxels(job.volume.pitch_mm(), options.predict_cell_mm);
    for (std::size_t a = 0; a < 3; ++a) job.cell_um[a] = cell[a] * job.volume.pitch_mm()[a] * 1e3;
    optics::Surface surface =
        optics::find_surface(scene, cell, body.is_picture ? optics::SurfacePart::top : optics::SurfacePart::all);
    const ModelMaker maker = [&](bool white) {
        ModelOptions quality;
        quality.cell_mm = options.predict_cell_mm;
        quality.memory_bytes = memory_budget(options.memory_gib) -
                               std::min(memory_budget(options.memory_gib), 2 * job.volume.memory_bytes());
        quality.seed = white ? ~options.seed : options.seed;
        return make_model(model, quality);
    };
    const int white = resins.set.find("W");
    job.predicted = predict_surface(scene, std::move(surface), maker, white >= 0 ? white : resins.core, progress);
    job.target = target_of_cells(job.predicted.surface, job.volume.pitch_mm(), body.grid.origin_mm, body.surface,
                                 body.model.mesh, &progress);
    job.difference = colour_differences(job.target, job.predicted.rgb);
    job.summary = summarize_by_area(job.predicted.surface, job.difference);
    progress.end_stage();
    job.seconds = watch.total();
    return job;
}

}  // namespace voxtone::slicer

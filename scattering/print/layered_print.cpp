// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/print/layered_print.h"

#include <fmt/core.h>

#include "base/stopwatch.h"
#include "scattering/print/layer_surfaces.h"
#include "slicer/part/phase.h"

namespace voxtone::scattering {

LayeredPrint::LayeredPrint(const slicer::OpenedJob& job, const LayeredOptions& options, const io::ProfileMap& map,
                           const slicer::JobBody& body, Progress& progress)
    : job_(job),
      options_(options),
      body_(body),
      layers_(arrange_layers(options, map, body, job.resins, progress)),
      parts_(job.options, body, job.resins, layers_->wrapped()) {
    for (const std::string& warning : layers_->warnings) progress.warn(warning);
}

void LayeredPrint::prepare(Progress& progress) {
    if (job_.run.goes_on)
        progress.note("--resume: layered profiles have no loop to go on with; the job begins at its start");
}

std::unique_ptr<const slicer::LayerSource> LayeredPrint::layers() const {
    return std::make_unique<slicer::LayerMaker>(parts_.sources(nullptr));
}

void LayeredPrint::expect_layers(const slicer::LayerRange& range) {
    if (job_.options.report) cut_.emplace(body_.grid, range.first, range.last, body_.grid.size[1] / 2);
}

void LayeredPrint::take_layer(int k, const io::LayerRuns& layer) {
    if (cut_) cut_->add(k, layer);
}

void LayeredPrint::evaluate(const io::StackDescription& stack, Progress& progress) {
    const Stopwatch watch;
    if (options_.surfaces)
        surfaces_ = write_layer_surfaces(layer_surfaces(body_, layers_->wrapped(), options_.surface_cell_mm, progress),
                                         job_.resins, stack, job_.options.out);
    surfaces_s_ = watch.total();
    if (job_.options.report && body_.is_picture && stack.layers == std::uint32_t(body_.grid.size[2]))
        spread_ = spread_section(layers_->map, stack, job_.options.out, job_.options.seed, progress);
    spread_s_ = watch.total() - surfaces_s_;
}

std::vector<io::ReportStage> LayeredPrint::stages_before_layers() const {
    return {{std::string(name_of(slicer::Phase::profiles)), layers_->materials_s},
            {std::string(name_of(slicer::Phase::search)), layers_->search_s}};
}

std::vector<io::ReportStage> LayeredPrint::stages_after_layers() const {
    std::vector<io::ReportStage> stages;
    if (!surfaces_.empty()) stages.push_back({"closed surfaces", surfaces_s_});
    if (spread_) stages.push_back({"trace", spread_s_});
    return stages;
}

void LayeredPrint::add_to(io::Report& report) const {
    std::optional<io::ReportPicture> cut;
    if (cut_)
        cut = cut_->picture(job_.palette(),
                            "cut through the middle of the print along x, upright; resins as the bitmaps colour them");
    add_layers_report(*layers_, job_.resins, cut, surfaces_, report);
    if (spread_) report.sections.push_back(*spread_);
}

void LayeredPrint::draw(io::Report& report, Progress& progress) const {
    draw_layers_report(*layers_, body_, report, job_.options.out, progress);
}

std::string LayeredPrint::summary(const io::Report&) const { return layers_summary(*layers_); }

std::string LayeredPrint::written_text() const {
    std::string text;
    for (const SurfaceFile& surface : surfaces_)
        text += fmt::format("  {}: {} triangles, {:.4f} ml\n", (job_.options.out / surface.name).string(),
                            surface.triangles, surface.mesh_ml);
    return text;
}

}  // namespace voxtone::scattering

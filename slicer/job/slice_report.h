// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a finished job says of itself: figures, pictures of the target and of what is expected, layers to look through.
//
// The prediction is that of an appearance model (job_prediction.h). Without one it is the separation's own: every point
// as if it lay on a wide flat shell of one colour over deep core, which shows what the resins can reach (gamut), not
// what light does between neighbouring colours, at edges and in thin parts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "voxtone/base/progress.h"
#include "voxtone/io/layers/manifest.h"
#include "voxtone/io/report/report_html.h"
#include "voxtone/slicer/job/job_body.h"
#include "voxtone/slicer/job/job_colour.h"
#include "voxtone/slicer/job/job_layers.h"
#include "voxtone/slicer/job/job_prediction.h"
#include "voxtone/slicer/job/layers_report.h"
#include "voxtone/slicer/layers/layer_maker.h"
#include "voxtone/slicer/options/slice_options.h"
#include "voxtone/slicer/printer/printer.h"
#include "voxtone/slicer/surface/surface_colour.h"

namespace voxtone::slicer {

/// What was measured while the job ran.
struct JobFigures {
    double read_s = 0, repair_s = 0, separation_s = 0, loop_s = 0, layers_s = 0, finish_s = 0, total_s = 0;
    double encode_s = 0;  ///< summed over threads, like those of `counts`
    LayerCounts counts;
    std::uint64_t layer_bytes = 0;
    std::vector<io::ReportLayer> layers;   ///< the ones to look through
    std::optional<io::ReportPicture> cut;  ///< through layered profiles
};

struct ReportSources {
    const SliceOptions& options;
    const PrinterProfile& printer;
    const LoadedResins& resins;
    const JobBody& body;
    const JobColour* colour;  ///< null: the surface is arranged by layers
    const JobLayers* layers;  ///< null: by colour
    const SurfaceColour& surface_colour;
    const io::StackDescription& stack;
    const JobPrediction* prediction;           ///< null: none was made
    const std::string& why_not;                ///< then: a sentence, or empty
    const JobLoop* loop;                       ///< null: none was made
    const std::string& why_no_loop;            ///< then: a sentence, or empty
    const std::vector<io::Rgb>& palette;       ///< background and resins, as the bitmaps colour them
    const std::vector<SurfaceFile>& surfaces;  ///< closed meshes of layers that were written
};

/// Figures, gamut and warnings; no pictures.
[[nodiscard]] io::Report make_report(const ReportSources& sources, const JobFigures& figures);

/// Draws the target, the prediction and, with a model, their difference into the report and writes target.* and
/// predicted.* into the folder: PNG and EXR for a picture, GLB for a body.
void draw_report(const ReportSources& sources, io::Report& report, const std::filesystem::path& folder,
                 Progress& progress);

/// A few lines for a person.
[[nodiscard]] std::string summary_text(const ReportSources& sources, const io::Report& report,
                                       const JobFigures& figures, const std::filesystem::path& folder);

}  // namespace voxtone::slicer

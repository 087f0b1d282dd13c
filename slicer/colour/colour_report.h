// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a report says of colours: how far they were moved into the gamut, what is expected of them, pictures of both.
//
// The prediction is that of an appearance model (job_prediction.h). Without one it is the separation's own: every point
// as if it lay on a wide flat shell of one colour over deep core, which shows what the resins can reach (gamut), not
// what light does between neighbouring colours, at edges and in thin parts.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "halftone/separation/translucency.h"
#include "io/report/report.h"
#include "slicer/colour/job_prediction.h"
#include "slicer/part/job_body.h"
#include "slicer/part/job_colour.h"
#include "slicer/part/opened_job.h"
#include "slicer/surface/coloured_surface.h"
#include "slicer/surface/surface_colour.h"

namespace voxtone::slicer {

struct ColourReport {
    const OpenedJob& job;
    const JobBody& body;
    const JobColour& colour;
    const SurfaceColour& surface_colour;
    const std::optional<JobPrediction>& prediction;
    /// Of the prediction's surface (cell_mesh.h), where it is a body's; for what draws it.
    std::vector<std::array<std::uint32_t, 3>> cell_triangles = {};
    const halftone::Translucency* translucency = nullptr;  ///< where alpha asks for it
};

/// The visible surface as it was asked for, and as the separation's own model says it will be.
[[nodiscard]] ColouredSurface target_surface(const ColourReport& sources);
[[nodiscard]] ColouredSurface separated_surface(const ColourReport& sources);

/// Gamut, prediction and its note, the section on mixtures.
void add_colour_report(const ColourReport& sources, const std::string& why_not_predicted, io::Report& report);

/// What the models remarked on the print that the loop chose and on the prediction, as warnings of the report.
void add_remarks(const std::optional<JobLoop>& loop, const std::optional<JobPrediction>& prediction,
                 io::Report& report);

/// Draws the target, the prediction, with a model their difference, and maps of alpha into the report and writes
/// target.* and predicted.* into the folder: PNG and EXR for a picture, GLB for a body.
void draw_colour_report(const ColourReport& sources, io::Report& report, const std::filesystem::path& folder,
                        Progress& progress);

/// The same cells in these colours, for pictures of them.
[[nodiscard]] SurfacePrediction cells_in_colours(const SurfacePrediction& cells,
                                                 const std::vector<Eigen::Vector3f>& rgb);

/// Lines of the job's summary.
[[nodiscard]] std::string colour_summary(const io::Report& report);

}  // namespace voxtone::slicer

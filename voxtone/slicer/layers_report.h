// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the report says of a print arranged by layers: how near the stacks come to the profiles that are wanted, which stacks
// these are, and where the body is too thin for them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "voxtone/base/progress.h"
#include "voxtone/io/report_html.h"
#include "voxtone/slicer/job_body.h"
#include "voxtone/slicer/job_colour.h"
#include "voxtone/slicer/job_layers.h"

namespace voxtone::slicer {

/// Sections with drawings, tables and a cut through the layers.
void add_layers_report(const JobLayers& layers, const LoadedResins& resins, const std::optional<io::ReportPicture>& cut, io::Report& report);

/// Lines of the job's summary.
[[nodiscard]] std::string layers_summary(const JobLayers& layers);

/// Draws the surface: total reflectance as wanted and as reached, and the distance of profiles. Of a picture also writes
/// target.png and predicted.png.
void draw_layers_report(const JobLayers& layers, const JobBody& body, io::Report& report, const std::filesystem::path& folder, Progress& progress);

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the report says of a print arranged by layers: how near the stacks come to the profiles that are wanted, which
// laminates these are, and where the body is too thin for them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "io/layers/manifest.h"
#include "io/report/report.h"
#include "scattering/print/job_layers.h"
#include "scattering/print/layer_surfaces.h"
#include "slicer/part/job_body.h"
#include "slicer/part/job_colour.h"

namespace voxtone::scattering {

/// A closed mesh of one resin (layer_surfaces.h), as it was written.
struct SurfaceFile {
    std::string name;  ///< "surfaces/W.ply", below the output folder
    std::size_t resin = 0, triangles = 0;
    double mesh_ml = 0, voxels_ml = 0;  ///< its volume, and that of the resin's voxels
};
/// Writes OUT/surfaces/ROLE.ply in the colours of the bitmaps; those of an earlier job are removed.
[[nodiscard]] std::vector<SurfaceFile> write_layer_surfaces(const std::vector<LayerSurface>& surfaces,
                                                            const slicer::LoadedResins& resins,
                                                            const io::StackDescription& stack,
                                                            const std::filesystem::path& folder);

/// Sections with drawings, tables and a cut through the layers.
void add_layers_report(const JobLayers& layers, const slicer::LoadedResins& resins,
                       const std::optional<io::ReportPicture>& cut, const std::vector<SurfaceFile>& surfaces,
                       io::Report& report);

/// How light spreads in the printed voxels of a slab, by a few paths from each place of its map: of a stack that is
/// whole in its folder. Where that cannot be traced, or takes too much memory, the section says why.
[[nodiscard]] io::ReportSection spread_section(const io::ProfileMap& map, const io::StackDescription& stack,
                                               const std::filesystem::path& folder, std::uint64_t seed,
                                               Progress& progress);

/// Lines of the job's summary.
[[nodiscard]] std::string layers_summary(const JobLayers& layers);

/// Draws the surface: total reflectance as wanted and as reached, and the distance of profiles. Of a picture also
/// writes target.png and predicted.png.
void draw_layers_report(const JobLayers& layers, const slicer::JobBody& body, io::Report& report,
                        const std::filesystem::path& folder, Progress& progress);

}  // namespace voxtone::scattering

// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/predict/prediction_page.h"

#include <algorithm>
#include <vector>

#include <fmt/core.h>

#include "base/process_usage.h"
#include "io/pictures/picture_writer.h"
#include "io/programs/build_identity.h"
#include "io/report/report_html.h"
#include "io/report/report_picture.h"
#include "slicer/look/prediction_files.h"
#include "slicer/look/preview.h"
#include "slicer/look/viewer_surface.h"
#include "slicer/look/voxel_sample.h"
#include "slicer/printer/printer.h"

namespace voxtone::slicer {

namespace {

/// Bitmaps' colours are the printer's; here it is not known, and the usual ones are taken.
void add_resins(const StackVolume& stack, io::Report& report) {
    const auto count = stack.volume.count();
    const auto& pitch = stack.volume.pitch_mm();
    std::vector<std::string> roles;
    for (const optics::Resin& resin : stack.resins.resins) roles.push_back(resin.role);
    const std::vector<io::Rgb> colours = find_printer("generic").display_colours(roles);
    for (std::size_t r = 0; r < roles.size(); ++r) {
        const std::uint64_t voxels = count[r + 1];
        report.resins.push_back({stack.resins.resins[r].name, roles[r], "", colours[r], voxels,
                                 double(voxels) * pitch[0] * pitch[1] * pitch[2] * 1e-3});
        report.body_voxels += voxels;
    }
}

io::ReportPicture picture_of(const char* caption, const io::LinearPicture& linear, double px_per_mm) {
    return io::report_picture(caption, io::encode_transparent(linear), px_per_mm);
}

void add_body_views(const StackVolume& stack, const SurfacePrediction& prediction, double cell_mm, io::Report& report) {
    const io::ColouredMesh mesh = body_mesh(stack.volume, {0, 0, 0}, prediction);
    std::vector<Eigen::Vector3d> positions;
    const ColouredSurface surface = mesh_surface(mesh, positions);
    PreviewOptions drawing;
    drawing.samples = 3;
    drawing.px_per_mm = std::min(fitting_scale(surface, all_views(), 480, drawing), 2 / cell_mm);
    for (const Preview& view : render_views(surface, all_views(), drawing))
        report.views.push_back({view_name(view.view), {picture_of("predicted", view.picture, view.px_per_mm)}});
}

}  // namespace

std::string prediction_page(const PredictionPage& page, const StackVolume& stack, const SurfacePrediction& prediction) {
    const auto& size = stack.volume.size();
    const auto& pitch = stack.volume.pitch_mm();
    const double cell_mm = *std::max_element(page.cell_um.begin(), page.cell_um.end()) * 1e-3;
    io::Report report;
    report.title = page.title;
    report.program_version = io::program_version();
    for (std::size_t a = 0; a < 3; ++a) {
        report.size_mm[a] = size[a] * pitch[a];
        report.size_px[a] = std::uint32_t(size[a]);
        report.pitch_um[a] = pitch[a] * 1e3;
    }
    report.total_seconds = page.seconds;
    report.peak_memory_bytes = peak_memory_bytes();
    report.warnings = prediction.remarks;
    report.prediction_note = fmt::format(
        "Predicted by the model {} from the voxels, in cells of {:.1f} x {:.1f} x {:.1f} um. What was asked for is not "
        "known from a stack alone: the report that `slice` writes has it.",
        page.model, page.cell_um[0], page.cell_um[1], page.cell_um[2]);
    add_resins(stack, report);
    const SurfaceLooks looks{{{"print", "what will be seen, by the model " + page.model, prediction.rgb}}, {}, {}};
    if (page.from_above) {
        const double px_per_mm = picture_px_per_mm(stack.volume, prediction.surface.cell_voxels)[0];
        report.views = {{"top", {picture_of("predicted", top_picture(stack.volume, prediction), px_per_mm)}}};
        report.viewer.surface = viewer_picture(stack.volume, prediction.surface, looks, surface_bytes_left(report));
    } else {
        add_body_views(stack, prediction, cell_mm, report);
        report.viewer.surface =
            viewer_body(body_mesh(stack.volume, {0, 0, 0}, prediction), looks, cell_mm, surface_bytes_left(report));
    }
    report.viewer.voxels = voxels_of(stack.volume, voxel_bytes_left(report));
    return io::report_html(report);
}

}  // namespace voxtone::slicer

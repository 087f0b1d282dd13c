// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/predict/prediction_writer.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <optional>
#include <vector>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/machine_memory.h"
#include "base/process_usage.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "io/models/glb_writer.h"
#include "io/models/ply_writer.h"
#include "io/profiles/lamp_file.h"
#include "optics/colour/channels.h"
#include "slicer/look/prediction_files.h"
#include "slicer/look/preview.h"
#include "slicer/predict/prediction_page.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

void write_from_above(const ResolvedPrediction& job, const StackVolume& stack, const SurfacePrediction& prediction) {
    const auto px_per_mm = picture_px_per_mm(stack.volume, prediction.surface.cell_voxels);
    for (std::size_t i = 0; i < job.kinds.size(); ++i) {
        const std::string& file = job.requested.files[i];
        if (job.kinds[i] == PredictedFile::exr)
            io::write_whole_file(
                file, io::exr_bytes(top_numbers(stack.volume, stack.resins.channels, prediction), px_per_mm));
        else if (job.kinds[i] == PredictedFile::png)
            io::write_whole_file(
                file, io::png_bytes(io::encode_transparent(top_picture(stack.volume, prediction)), px_per_mm));
    }
}

void write_views(const std::string& file, const io::ColouredMesh& mesh, double cell_mm, const Progress& progress) {
    std::vector<Eigen::Vector3d> positions;
    const ColouredSurface surface = mesh_surface(mesh, positions);
    PreviewOptions drawing;
    drawing.samples = 3;
    drawing.px_per_mm = std::min(fitting_scale(surface, all_views(), 640, drawing), 2 / cell_mm);
    const std::vector<Preview> views = render_views(surface, all_views(), drawing, &progress);
    io::write_whole_file(
        file, io::png_bytes(io::encode_transparent(side_by_side(views)), {drawing.px_per_mm, drawing.px_per_mm}));
}

/// The print as a material among others: jetted and glossy, behind its surface the resin that most of it is of. Light
/// fades there as diffuse light does, by sqrt(3 sigma_a (sigma_a + (1 - g) sigma_s)) (A. Ishimaru, "Wave propagation
/// and scattering in random media", 1978); the thickness is half the mean chord of a convex body, 4 V / A (Cauchy).
io::LitMaterial material_of(const StackVolume& stack, const SurfacePrediction& prediction) {
    constexpr double jetted_roughness = 0.1;  // a guess until measured
    const auto count = stack.volume.count();
    const auto most = std::max_element(count.begin() + 1, count.end()) - count.begin();
    const optics::Resin& resin = stack.resins.resins[static_cast<std::size_t>(most - 1)];
    const std::size_t channels = stack.resins.channels.size();
    Eigen::VectorXd kept(static_cast<Eigen::Index>(channels));
    for (std::size_t c = 0; c < channels; ++c) {
        const optics::Medium m = resin.medium(c);
        kept[static_cast<Eigen::Index>(c)] =
            std::exp(-std::sqrt(3 * m.sigma_a * (m.sigma_a + (1 - stack.resins.g) * m.sigma_s)));
    }
    const Eigen::Vector3d rgb = optics::linear_srgb_weights(stack.resins.channels) * kept;
    const auto& pitch = stack.volume.pitch_mm();
    const double volume =
        double(std::accumulate(count.begin() + 1, count.end(), std::uint64_t{0})) * pitch[0] * pitch[1] * pitch[2];
    double area = 0;
    for (const optics::SurfaceCell& cell : prediction.surface.cells) area += double(cell.area_mm2);
    io::LitMaterial lit{jetted_roughness, stack.resins.eta, 2 * volume / area, {}};
    for (std::size_t c = 0; c < 3; ++c)
        lit.transmitted_by_mm[c] = std::clamp(rgb[static_cast<Eigen::Index>(c)], 1e-6, 1.0);
    return lit;
}

void write_body(const ResolvedPrediction& job, const StackVolume& stack, const SurfacePrediction& prediction,
                const Progress& progress) {
    const io::ColouredMesh mesh = body_mesh(stack.volume, stack.corner_mm, prediction);
    if (mesh.triangles.empty())
        throw InputError(fmt::format(
            "{}: the body is not larger than a cell of {:g} mm: it has no surface to show; give a smaller --cell",
            job.requested.stack, job.requested.cell_mm));
    std::optional<io::LitMaterial> lit;
    if (job.requested.lit) lit = material_of(stack, prediction);
    for (std::size_t i = 0; i < job.kinds.size(); ++i) {
        const std::string& file = job.requested.files[i];
        if (job.kinds[i] == PredictedFile::glb)
            io::write_whole_file(file, io::glb_bytes(mesh, "predicted", lit));
        else if (job.kinds[i] == PredictedFile::ply)
            io::write_whole_file(file, io::ply_bytes(mesh, body_numbers(stack.resins.channels, prediction)));
        else if (job.kinds[i] == PredictedFile::png)
            write_views(file, mesh, job.requested.cell_mm, progress);
    }
}

void write_pages(const ResolvedPrediction& job, const StackVolume& stack, const SurfacePrediction& prediction,
                 const PredictFigures& f) {
    const PredictionPage page{fs::path(job.requested.stack).filename().string(), std::string(name_of(job.model)),
                              f.from_above, f.cell_um, f.read_s + f.surface_s + f.predict_s};
    for (std::size_t i = 0; i < job.kinds.size(); ++i)
        if (job.kinds[i] == PredictedFile::html)
            io::write_whole_file(job.requested.files[i], prediction_page(page, stack, prediction));
}

std::array<double, 3> mean_colour(const SurfacePrediction& prediction) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double area = 0;
    for (std::size_t i = 0; i < prediction.rgb.size(); ++i) {
        sum += prediction.surface.cells[i].area_mm2 * prediction.rgb[i].cast<double>();
        area += prediction.surface.cells[i].area_mm2;
    }
    sum /= area;
    return {sum.x(), sum.y(), sum.z()};
}

}  // namespace

void write_prediction(const ResolvedPrediction& job, const PredictedStack& predicted, const PredictFigures& figures,
                      const Progress& progress) {
    const auto& [stack, prediction] = predicted;
    figures.from_above ? write_from_above(job, stack, prediction) : write_body(job, stack, prediction, progress);
    write_pages(job, stack, prediction, figures);
}

void add_means(const SurfacePrediction& prediction, PredictFigures& figures) {
    figures.mean = mean_colour(prediction);
    const auto& errors = prediction.standard_error;
    if (errors.empty()) return;
    figures.mean_error = std::accumulate(errors.begin(), errors.end(), 0.0) / double(errors.size());
    figures.largest_error = *std::max_element(errors.begin(), errors.end());
}

PredictResult describe(const ResolvedPrediction& job, const PredictedStack& predicted, const PredictFigures& f) {
    const auto& [stack, prediction] = predicted;
    const PredictOptions& options = job.requested;
    const bool errors = !prediction.standard_error.empty();
    const double seconds = f.read_s + f.surface_s + f.predict_s + f.write_s;
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-prediction").add("version", 1).add("stack", options.stack);
    json.add("files", options.files).add("model", name_of(job.model)).add("view", f.from_above ? "top" : "body");
    json.add("backing", f.backing.words).add("boundary", name_of(f.boundary));
    json.add("light_outside", name_of(job.outside));
    json.add("relative_to", options.absolute ? "entered light" : "white resin").add("resins", stack.resins.name);
    json.add("illuminant", stack.illuminant);
    json.add("channels", prediction.channels).add("voxels", stack.volume.size());
    json.add("volume_bytes", stack.volume.memory_bytes()).add("cell_um", f.cell_um);
    json.add("cells", prediction.surface.cells.size()).add("mean_rgb", f.mean);
    if (f.from_above) json.add("size_px", picture_cells(stack.volume, prediction.surface.cell_voxels));
    if (errors)
        json.key("standard_error").begin_object().add("mean", f.mean_error).add("max", f.largest_error).end_object();
    json.add("warnings", prediction.remarks).key("seconds").begin_object().add("read", f.read_s);
    json.add("surface", f.surface_s).add("predict", f.predict_s).add("write", f.write_s).end_object();
    json.add("peak_memory_bytes", peak_memory_bytes()).end_object();

    std::string text = fmt::format("{}: {} cells of {:.1f} x {:.1f} x {:.1f} um, {}, {} values, {} under it\n",
                                   fmt::join(options.files, ", "), prediction.surface.cells.size(), f.cell_um[0],
                                   f.cell_um[1], f.cell_um[2], f.from_above ? "seen from above" : "the whole surface",
                                   options.absolute ? "absolute" : "media-relative",
                                   f.from_behind                        ? "a source of light"
                                   : f.backing == optics::Backing::none ? "nothing"
                                                                        : fmt::format("a {} sheet", f.backing.words));
    text += fmt::format("  mean colour (linear sRGB{}): {:.4f} {:.4f} {:.4f}\n",
                        stack.illuminant == io::usual_lamp ? "" : ", under " + stack.illuminant, f.mean[0], f.mean[1],
                        f.mean[2]);
    if (errors)
        text +=
            fmt::format("  standard error of a value: mean {:.4f}, largest {:.4f}\n", f.mean_error, f.largest_error);
    text += fmt::format("  {} in {:.2f} s ({:.2f} s of them in the model), peak memory {}\n", name_of(job.model),
                        seconds, f.predict_s, memory_text(peak_memory_bytes()));
    return {json.text(), text};
}

}  // namespace voxtone::slicer

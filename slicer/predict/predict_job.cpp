// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/predict/predict_job.h"

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <system_error>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/job_outlook.h"
#include "base/parallel.h"
#include "base/process_usage.h"
#include "base/stopwatch.h"
#include "base/warning.h"
#include "io/disk/disk_space.h"
#include "io/disk/output_files.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "io/layers/stack_folder.h"
#include "io/models/glb_writer.h"
#include "io/models/ply_writer.h"
#include "optics/colour/channels.h"
#include "slicer/look/coarse_cells.h"
#include "slicer/look/prediction_files.h"
#include "slicer/look/prediction_time.h"
#include "slicer/look/preview.h"
#include "slicer/look/surface_prediction.h"
#include "slicer/options/option_values.h"
#include "slicer/predict/parts_in_sight.h"
#include "slicer/predict/prediction_page.h"
#include "slicer/predict/stack_boundary.h"
#include "slicer/predict/stack_volume.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

std::string extension(const std::string& file) {
    std::string ending = fs::path(file).extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return ending;
}

double voxels_of(const StackHead& head) { return double(head.size[0]) * head.size[1] * head.size[2]; }

/// A slab of a picture, and a box that is not higher than it is wide, are looked at from above.
bool is_flat(const StackHead& head) {
    std::array<double, 3> mm{};
    for (std::size_t a = 0; a < 3; ++a) mm[a] = head.size[a] * head.pitch_mm[a];
    return head.of_picture || (double(head.solid_voxels) == voxels_of(head) && mm[2] <= std::min(mm[0], mm[1]));
}

bool seen_from_above(const ResolvedPrediction& job, const StackHead& head) {
    return job.view == PredictedView::top || (job.view == PredictedView::automatic && is_flat(head));
}

std::uint64_t surface_bytes(const optics::Surface& surface) {
    return surface.cells.size() * (sizeof(optics::SurfaceCell) + sizeof(float) * 3) +
           surface.faces.size() * sizeof(optics::SurfaceFace);
}

/// "auto": nothing.
std::optional<optics::Backing> backing_or_auto(const std::string& text) {
    if (text == "auto") return std::nullopt;
    const auto backing = value_of<optics::Backing>(text);
    if (!backing) refuse_choice("backing", text, {"auto", "black", "white", "none"});
    return backing;
}

void expect_files_fit(const ResolvedPrediction& job, bool from_above) {
    for (std::size_t i = 0; i < job.kinds.size(); ++i) {
        const std::string& file = job.requested.files[i];
        const PredictedFile kind = job.kinds[i];
        if (from_above && (kind == PredictedFile::glb || kind == PredictedFile::ply))
            throw UsageError(
                fmt::format("{}: the stack is seen from above as a picture (.png, .exr); for a mesh of its whole "
                            "surface give --view body",
                            file));
        if (!from_above && kind == PredictedFile::exr)
            throw UsageError(fmt::format(
                "{}: the stack is seen as a body (.glb, .ply, .png); for a picture from above give --view top", file));
    }
}

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

struct PredictFigures {
    optics::Backing backing{};
    bool from_behind = false;  ///< lit from there alone
    BodyEnd boundary = BodyEnd::voxels;
    bool from_above = false;
    std::array<double, 3> cell_um{};
    std::array<double, 3> mean{};
    double mean_error = 0, largest_error = 0;
    double read_s = 0, surface_s = 0, predict_s = 0, write_s = 0;
};

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

PredictResult describe(const ResolvedPrediction& job, const StackVolume& stack, const SurfacePrediction& prediction,
                       const PredictFigures& f) {
    const PredictOptions& options = job.requested;
    const bool errors = !prediction.standard_error.empty();
    const double seconds = f.read_s + f.surface_s + f.predict_s + f.write_s;
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-prediction").add("version", 1).add("stack", options.stack);
    json.add("files", options.files).add("model", name_of(job.model)).add("view", f.from_above ? "top" : "body");
    json.add("backing", name_of(f.backing)).add("boundary", name_of(f.boundary));
    json.add("light_outside", name_of(job.outside));
    json.add("relative_to", options.absolute ? "entered light" : "white resin").add("resins", stack.resins.name);
    json.add("channels", prediction.channels).add("voxels", stack.volume.size());
    json.add("volume_bytes", stack.volume.memory_bytes()).add("cell_um", f.cell_um);
    json.add("cells", prediction.surface.cells.size()).add("mean_rgb", f.mean);
    if (f.from_above) json.add("size_px", picture_cells(stack.volume, prediction.surface.cell_voxels));
    if (errors)
        json.key("standard_error").begin_object().add("mean", f.mean_error).add("max", f.largest_error).end_object();
    json.add("warnings", prediction.remarks).key("seconds").begin_object().add("read", f.read_s);
    json.add("surface", f.surface_s).add("predict", f.predict_s).add("write", f.write_s).end_object();
    json.add("peak_memory_bytes", peak_memory_bytes()).end_object();

    std::string text = fmt::format(
        "{}: {} cells of {:.1f} x {:.1f} x {:.1f} um, {}, {} values, {} under it\n", fmt::join(options.files, ", "),
        prediction.surface.cells.size(), f.cell_um[0], f.cell_um[1], f.cell_um[2],
        f.from_above ? "seen from above" : "the whole surface", options.absolute ? "absolute" : "media-relative",
        f.from_behind                        ? "a source of light"
        : f.backing == optics::Backing::none ? "nothing"
                                             : fmt::format("a {} sheet", name_of(f.backing)));
    text += fmt::format("  mean colour (linear sRGB): {:.4f} {:.4f} {:.4f}\n", f.mean[0], f.mean[1], f.mean[2]);
    if (errors)
        text +=
            fmt::format("  standard error of a value: mean {:.4f}, largest {:.4f}\n", f.mean_error, f.largest_error);
    text += fmt::format("  {} in {:.2f} s ({:.2f} s of them in the model), peak memory {:.0f} MB\n", name_of(job.model),
                        seconds, f.predict_s, double(peak_memory_bytes()) * 1e-6);
    return {json.text(), text};
}

/// Before anything is read: a body has half the surface of its box, about; of a slab the top is seen.
double guessed_area_mm2(const std::array<int, 3>& voxels, const std::array<double, 3>& pitch_mm, PredictedView view) {
    std::array<double, 3> edge{};
    for (std::size_t a = 0; a < 3; ++a) edge[a] = voxels[a] * pitch_mm[a];
    const double top = edge[0] * edge[1];
    const bool slab = 5 * edge[2] < std::min(edge[0], edge[1]);
    if (view == PredictedView::top || (view == PredictedView::automatic && slab)) return top;
    return top + edge[2] * (edge[0] + edge[1]);
}

/// The stages that are still to come, for the time that is shown as left; `read_s`: of the layers, 0 where they are
/// read.
void expect_rest(const ResolvedPrediction& job, double read_s, double area_mm2, const std::array<double, 3>& pitch_mm,
                 std::size_t channels, Progress& progress) {
    // Two cores of 2.5 GHz, by `voxtone predict` of the bundled cow at 15 and 30 mm.
    constexpr double surface_s_per_mm2 = 3e-4, write_s_per_mm2 = 5e-4;
    ModelOptions quality = job.requested.quality;
    quality.cell_mm = job.requested.cell_mm;
    std::vector<ExpectedStage> stages;
    if (read_s > 0) {
        stages.push_back({"read layers", read_s});
        stages.push_back({"find the surface", surface_s_per_mm2 * area_mm2});
    }
    stages.push_back({"predict", prediction_seconds(job.model, quality, pitch_mm, area_mm2, channels)});
    stages.push_back({"write", write_s_per_mm2 * area_mm2});
    expect_stages(progress, std::move(stages));
}

/// Cells of a larger size than the eye's are put together from the eye's.
std::optional<CoarseCells> quick_cells(const ResolvedPrediction& job, const std::array<double, 3>& pitch_mm) {
    if (job.model != PredictionModel::transport) return std::nullopt;
    return coarse_cells(pitch_mm, job.requested.cell_mm);
}

ModelOptions model_options(const ResolvedPrediction& job, bool quick, std::uint64_t memory_bytes) {
    ModelOptions quality = job.requested.quality;
    quality.cell_mm = quick ? eye_cell_mm : job.requested.cell_mm;
    quality.viewing_cells = quick;
    quality.memory_bytes = memory_bytes;
    return quality;
}

double gibibytes(double bytes) { return bytes / (1 << 30); }

/// By what is held of any body of this size: the least of its volume, of its surface and of the model, which takes
/// smaller tiles where there is little left.
void expect_memory(const ResolvedPrediction& job, const StackHead& head) {
    constexpr double edge = optics::ResinVolume::block_edge, block_voxels = edge * edge * edge;
    const double volume = voxels_of(head) / block_voxels * sizeof(std::int32_t);
    // A column holds a voxel per layer at most, and has an upper face.
    const double surface = double(head.solid_voxels) / head.size[2] * sizeof(optics::SurfaceFace);
    const double solid_mm3 = double(head.solid_voxels) * head.pitch_mm[0] * head.pitch_mm[1] * head.pitch_mm[2];
    const bool quick = quick_cells(job, head.pitch_mm).has_value();
    const std::uint64_t model =
        least_model_bytes(job.model, model_options(job, quick, job.memory_bytes), solid_mm3, head.pitch_mm);
    const double needed = volume * (job.requested.absolute ? 1 : 2) + surface + double(model);
    if (needed <= double(job.memory_bytes)) return;
    throw ResourceError(fmt::format(
        "{}: a prediction of its {} x {} x {} voxels needs at least {:.2f} GiB, more than the {:.2f} GiB allowed; "
        "allow more (--memory), {}or predict a smaller print",
        job.requested.stack, head.size[0], head.size[1], head.size[2], gibibytes(needed),
        gibibytes(double(job.memory_bytes)), quick ? "" : "take larger cells (--cell 0.2mm), "));
}

void expect_white(const ResolvedPrediction& job, const StackHead& head) {
    if (job.requested.absolute || head.has_white) return;
    throw InputError(
        fmt::format("the resin set '{}' has no white (role W) for media-relative values to refer to; name another "
                    "set with --resins, or give --absolute",
                    head.resin_set));
}

struct ReadStack {
    StackHead head;
    StackVolume volume;
};

/// All that the head of the stack can refuse is refused before its layers are read.
ReadStack read_stack(const ResolvedPrediction& job, Progress& progress) {
    const PredictOptions& options = job.requested;
    ReadStack stack;
    const auto check_head = [&](const StackHead& head) {
        constexpr double read_s_per_voxel = 1e-8;
        stack.head = head;
        if (job.only_from_above && !seen_from_above(job, head))
            throw InputError(fmt::format(
                "{}: the stack is a body; photographs are compared with slabs and pictures so far, which are flat: see "
                "a body from the camera's place with `voxtone proof {} --camera X,Y,Z`, and compare by eye",
                job.requested.stack, job.requested.stack));
        expect_white(job, head);
        expect_files_fit(job, seen_from_above(job, head));
        expect_memory(job, head);
        constexpr std::size_t usual_channels = 3;  // what the resins have is known with the layers
        expect_rest(job, read_s_per_voxel * voxels_of(head), guessed_area_mm2(head.size, head.pitch_mm, job.view),
                    head.pitch_mm, usual_channels, progress);
    };
    // The volume and, for relative values, its white twin are held at once.
    stack.volume = read_stack_volume({.stack = options.stack,
                                      .resins = options.resins,
                                      .printer = options.printer,
                                      .pitch_mm = job.pitch_mm,
                                      .assign = job.assign,
                                      .nearest = options.nearest,
                                      .memory_bytes = job.memory_bytes / (options.absolute ? 1 : 2),
                                      .below_coat = true,
                                      .before_reading = check_head},
                                     progress);
    // As it is, whatever a manifest says.
    stack.head.solid_voxels = std::uint64_t(voxels_of(stack.head)) - stack.volume.volume.count()[optics::air];
    return stack;
}

/// From where it is seen, and over what.
void look_from(const ResolvedPrediction& job, const ReadStack& stack, PredictFigures& figures) {
    figures.from_above = seen_from_above(job, stack.head);
    const optics::Backing usual = figures.from_above ? optics::Backing::black : optics::Backing::none;
    figures.backing = job.backing.value_or(stack.volume.backing.value_or(usual));
    figures.from_behind = stack.volume.from_behind && figures.from_above && !job.backing;
    if (figures.from_behind) figures.backing = optics::Backing::none;
}

/// Where light paths leave the body: nothing for its voxels' faces. Throws InputError where the mesh was asked for and
/// cannot be had.
std::optional<MeshBoundary> find_boundary(const ResolvedPrediction& job, const StackVolume& stack,
                                          const PredictFigures& figures, Progress& progress) {
    if (job.model != PredictionModel::monte_carlo || job.boundary == BodyEnd::voxels) return std::nullopt;
    StackBoundary found;
    if (figures.backing != optics::Backing::none)
        found.why_not = "what lies on a sheet ends there, and light paths know sheets under voxels alone";
    else
        found = boundary_of_stack(job.requested.stack, stack, progress);
    if (found.mesh) return std::move(found.mesh);
    if (job.boundary == BodyEnd::mesh)
        throw InputError(fmt::format("--boundary mesh: {}; give --boundary voxels, or slice again", found.why_not));
    if (figures.backing == optics::Backing::none)
        progress.warn(named_warning(
            "voxel-surface",
            fmt::format("light leaves at the faces of the voxels, which shows slanting faces up to 7 CIEDE2000 "
                        "too light, and not at the mesh: {}",
                        found.why_not)));
    return std::nullopt;
}

optics::SurfacePart seen_part(const PredictFigures& figures) {
    return figures.from_above ? optics::SurfacePart::top : optics::SurfacePart::all;
}

/// For models that take each place by itself; nothing where light between parts is not asked for, or followed by paths.
std::optional<PartsInSight> find_parts_in_sight(const ResolvedPrediction& job, const optics::ResinVolume& volume,
                                                const optics::Surface& surface, const PredictFigures& figures,
                                                Progress& progress) {
    if (job.outside != LightOutside::followed || job.model == PredictionModel::monte_carlo) return std::nullopt;
    if (figures.from_above)
        throw InputError(
            "--outside followed: a stack that is seen from above as a picture has no parts that light passes between; "
            "give --view body, or leave it out");
    return PartsInSight(volume, surface, &progress);
}

/// The cells that are predicted, and those that they are averaged over where they are not the same.
struct PredictedCells {
    optics::Surface surface;
    std::optional<optics::Surface> averaged_over;
};

PredictedCells find_cells(const optics::Scene& scene, const ResolvedPrediction& job, PredictFigures& figures,
                          Progress& progress) {
    progress.begin_stage("find the surface", 0);
    const std::array<double, 3>& pitch_mm = scene.volume->pitch_mm();
    const optics::SurfacePart part = seen_part(figures);
    const std::optional<CoarseCells> coarse = quick_cells(job, pitch_mm);
    const auto cell = seen_cell_voxels(pitch_mm, job.requested.cell_mm);
    for (std::size_t a = 0; a < 3; ++a) figures.cell_um[a] = cell[a] * pitch_mm[a] * 1e3;
    PredictedCells cells;
    cells.surface = optics::find_surface(scene, cell, part, &progress);
    if (coarse) {
        cells.averaged_over = std::move(cells.surface);
        cells.surface = optics::find_surface(scene, coarse->eye, part, &progress);
    }
    progress.end_stage();
    return cells;
}

/// Throws ResourceError where more is held than allowed.
void note_memory(const ResolvedPrediction& job, const optics::ResinVolume& volume, std::size_t cells,
                 std::uint64_t held, const PredictFigures& figures, Progress& progress) {
    const auto& size = volume.size();
    const std::uint64_t budget = job.memory_bytes;
    const bool fast = job.model == PredictionModel::transport;
    progress.note(
        fmt::format("{} x {} x {} voxels and {} surface cells of {:.1f} x {:.1f} x {:.1f} um take {}{} of the {} "
                    "allowed (--memory)",
                    size[0], size[1], size[2], cells, figures.cell_um[0], figures.cell_um[1], figures.cell_um[2],
                    io::bytes_text(held),
                    fast ? fmt::format(", their light up to {},",
                                       io::bytes_text(static_cast<std::uint64_t>(prediction_bytes(double(cells)))))
                         : "",
                    io::bytes_text(budget)));
    if (held <= budget) return;
    throw ResourceError(
        fmt::format("the volume and its surface need {:.2f} GiB, more than the {:.2f} GiB allowed; allow more "
                    "(--memory), choose larger cells (--cell) or a smaller print",
                    gibibytes(double(held)), gibibytes(double(budget))));
}

void add_means(const SurfacePrediction& prediction, PredictFigures& figures) {
    figures.mean = mean_colour(prediction);
    const auto& errors = prediction.standard_error;
    if (errors.empty()) return;
    figures.mean_error = std::accumulate(errors.begin(), errors.end(), 0.0) / double(errors.size());
    figures.largest_error = *std::max_element(errors.begin(), errors.end());
}

/// All but that there are files.
ResolvedPrediction checked_options(const PredictOptions& o) {
    const auto need = [](bool good, std::string_view key, const std::string& value, std::string_view rule) {
        if (!good) throw UsageError(fmt::format("--{} {}: {}", key, value, rule));
    };
    ResolvedPrediction job;
    job.requested = o;
    need(!o.lit || std::any_of(o.files.begin(), o.files.end(), [](const auto& f) { return extension(f) == ".glb"; }),
         "lit", "", "would be ignored: it only goes with a .glb");
    for (const std::string& file : o.files) {
        const auto kind = value_of<PredictedFile>(extension(file));
        need(
            kind.has_value(), "out", file,
            "the name says the kind of file: .png or .exr (slab), .glb, .ply or .png (body), .html (a page of either)");
        job.kinds.push_back(*kind);
    }
    need(o.cell_mm >= 0.01 && o.cell_mm <= 5, "cell", fmt::format("{}mm", o.cell_mm), "must be 0.01 to 5 mm");
    need(o.quality.paths >= 2 && o.quality.paths <= 1u << 20, "spp", fmt::format("{}", o.quality.paths),
         "must be 2 to 1048576");
    need(o.quality.error >= 0 && o.quality.error < 1, "error", fmt::format("{}", o.quality.error),
         "must be 0 (none wanted) or below 1");
    need(o.quality.sweeps >= 1 && o.quality.sweeps <= 100, "sweeps", fmt::format("{}", o.quality.sweeps),
         "must be 1 to 100");
    need(o.memory_gib >= 0 && o.memory_gib <= most_memory_gib, "memory", fmt::format("{}", o.memory_gib),
         "must be above 0 GiB, or 0 for half of the machine's");
    need(o.threads >= 0 && o.threads <= 1024, "threads", fmt::format("{}", o.threads), "must be 0 to 1024");
    job.boundary = parse_choice<BodyEnd>("boundary", o.boundary);
    job.outside = parse_choice<LightOutside>("outside", o.outside);
    job.model = parse_choice<PredictionModel>("model", o.model);
    if (job.outside == LightOutside::followed && job.model == PredictionModel::monte_carlo) {
        need(job.boundary != BodyEnd::voxels, "outside", o.outside, "needs the mesh: not with --boundary voxels");
        job.boundary = BodyEnd::mesh;
    }
    job.view = parse_choice<PredictedView>("view", o.view);
    job.backing = backing_or_auto(o.backing);
    if (!o.pitch.empty()) job.pitch_mm = parse_pitch_mm(o.pitch);
    for (const std::string& text : o.assign) job.assign.push_back(parse_assignment(text));
    job.memory_bytes = memory_budget(o.memory_gib);
    if (job.view != PredictedView::automatic) expect_files_fit(job, job.view == PredictedView::top);
    return job;
}

/// `figures`: all but the time of writing and the means.
PredictedStack predict_checked(const ResolvedPrediction& job, PredictFigures& figures, Progress& progress) {
    const PredictOptions& options = job.requested;
    Stopwatch watch;
    ReadStack read = read_stack(job, progress);
    StackVolume& stack = read.volume;
    figures.read_s = watch.lap();

    look_from(job, read, figures);
    expect_files_fit(job, figures.from_above);
    const optics::Scene scene{.volume = &stack.volume, .resins = &stack.resins, .backing = figures.backing};
    const std::uint64_t volumes = stack.volume.memory_bytes() * (options.absolute ? 1 : 2);
    const bool quick = quick_cells(job, stack.volume.pitch_mm()).has_value();
    PredictedCells cells = find_cells(scene, job, figures, progress);
    const std::optional<MeshBoundary> boundary = find_boundary(job, stack, figures, progress);
    figures.boundary = boundary ? BodyEnd::mesh : BodyEnd::voxels;
    const std::optional<PartsInSight> parts = find_parts_in_sight(job, stack.volume, cells.surface, figures, progress);
    figures.surface_s = watch.lap();
    const std::uint64_t held = volumes + surface_bytes(cells.surface) + (parts ? parts->memory_bytes() : 0);
    note_memory(job, stack.volume, cells.surface.cells.size(), held, figures, progress);

    double area_mm2 = 0;
    for (const optics::SurfaceCell& cell : cells.surface.cells) area_mm2 += double(cell.area_mm2);
    expect_rest(job, 0, area_mm2, stack.volume.pitch_mm(), stack.resins.channels.size(), progress);
    progress.begin_stage("predict", 0);
    ModelOptions quality = model_options(job, quick, job.memory_bytes - held);
    quality.from_behind = figures.from_behind;
    if (!figures.from_behind) set_depth_of_cells(quality, scene.backing);
    quality.boundary = boundary ? &*boundary : nullptr;
    quality.follow_outside = job.outside == LightOutside::followed;
    auto model = make_model(job.model, quality);
    if (parts) model = with_light_between_parts(std::move(model), *parts);
    const std::optional<optics::ResinVolume> white = white_print(stack);
    SurfacePrediction prediction = predict_surface(scene, std::move(cells.surface), *model,
                                                   options.absolute      ? -1
                                                   : figures.from_behind ? stack.clear
                                                                         : stack.white,
                                                   progress, white && !figures.from_behind ? &*white : nullptr);
    if (quick) prediction = averaged(prediction, std::move(*cells.averaged_over), seen_part(figures));
    progress.end_stage();
    figures.predict_s = watch.lap();
    return {std::move(stack), std::move(prediction)};
}

}  // namespace

ResolvedPrediction resolve(const PredictOptions& o) {
    if (o.files.empty()) throw UsageError("--out (none): name a file: -o FILE.png");
    return checked_options(o);
}

PredictedStack predict_from_above(const PredictOptions& options, Progress& progress) {
    ResolvedPrediction job = checked_options(options);
    job.only_from_above = true;
    const ThreadLimit threads(static_cast<std::size_t>(options.threads));
    PredictFigures figures;
    return predict_checked(job, figures, progress);
}

PredictResult run_predict_job(const PredictOptions& options, Progress& progress) {
    const ResolvedPrediction job = resolve(options);
    const std::vector<std::filesystem::path> files(options.files.begin(), options.files.end());
    io::expect_apart_from_layers(options.stack, files);
    io::expect_outputs(files, options.overwrite);
    const ThreadLimit threads(static_cast<std::size_t>(options.threads));
    PredictFigures figures;
    const PredictedStack predicted = predict_checked(job, figures, progress);
    const StackVolume& stack = predicted.stack;
    const SurfacePrediction& prediction = predicted.prediction;
    Stopwatch watch;
    progress.begin_stage("write", 0);
    figures.from_above ? write_from_above(job, stack, prediction) : write_body(job, stack, prediction, progress);
    write_pages(job, stack, prediction, figures);
    progress.end_stage();
    figures.write_s = watch.lap();
    add_means(prediction, figures);
    return describe(job, stack, prediction, figures);
}

}  // namespace voxtone::slicer

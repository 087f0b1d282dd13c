// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/job_body.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include <fmt/core.h>

#include "base/contracts.h"
#include "base/error.h"
#include "base/printable.h"
#include "base/stopwatch.h"
#include "base/warning.h"
#include "io/models/model_reader.h"
#include "slicer/mesh/box.h"
#include "slicer/mesh/parted_sheets.h"
#include "slicer/printer/picture_slab.h"
#include "slicer/printer/up_axis.h"
#include "slicer/solid/cavities.h"
#include "slicer/surface/lay_marks.h"
#include "slicer/surface/thin_walls.h"
#include "slicer/surface/white_surface.h"

namespace voxtone::slicer {

namespace {

void append(std::vector<std::string>& to, const std::vector<std::string>& from) {
    to.insert(to.end(), from.begin(), from.end());
}

io::ModelFile read_input(const ResolvedJob& job, io::ModelSources& sources, const Progress& progress) {
    if (job.is_picture()) {
        PictureOptions printed = job.picture;
        if (job.shows_colours()) printed.thickness_mm = printed_mm(job.picture, job.colour);
        PictureSlab slab = make_picture_slab(read_input_picture(job, progress), printed);
        append(sources.notes, slab.notes);
        return std::move(slab.model);
    }
    io::ReadOptions reading = job.reading;
    reading.progress = &progress;
    reading.texture = job.texture;
    return io::read_model(job.model, reading, sources);
}

/// Only the top of a picture's slab carries colour: its depth is measured from there, up to the very edge.
VisibleSurface picture_surface(const io::TexturedMesh& mesh, bool with_sides = false) {
    VisibleSurface surface;
    surface.positions_mm = mesh.positions;
    const Eigen::Vector2f zero(0, 0), one_u(1, 0), one_v(0, 1);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        if (!with_sides && mesh.material_of_triangle[t] != PictureSlab::face_material) continue;
        surface.triangles.push_back(mesh.triangles[t]);
        surface.source_triangle.push_back(t);
        surface.source_uv.push_back({zero, one_u, one_v});
    }
    return surface;
}

/// With --strict what is lost or white ends the job before time is spent on it.
void refuse_lost_colour(const ResolvedJob& job, const io::ModelFile& model) {
    if (!job.strict || !job.shows_colours() || model.lost_colour.empty()) return;
    throw InputError(fmt::format("--strict: {} Without --strict the model is printed as it is.", model.lost_colour));
}

/// What is lost was said.
void look_for_colour(const ResolvedJob& job, JobBody& body) {
    if (!body.model.lost_colour.empty()) return;
    if (!job.shows_colours() || !body.model.wants_colour || !is_all_white(body.model.mesh, *body.surface)) return;
    const std::string what = fmt::format(
        "{} has colours, but none of them is on its surface, so that it comes out all white; look at its materials and "
        "its texture coordinates in a mesh editor",
        job.model);
    if (job.strict) throw InputError("--strict: " + what);
    body.warnings.push_back(named_warning("no-colour", what));
}

void look_for_cavities(const ResolvedJob& job, const PrinterProfile& printer, RepairedMesh& repaired, JobBody& body,
                       Progress& progress) {
    CavityOptions options;
    options.mode = job.cavities;
    options.shell_mm = job.shell_mm();
    options.pitch_mm = printer.sliced_pitch_mm().maxCoeff();
    repaired.report.voids = treat_cavities(repaired, options, &progress);
    for (const std::string& said : cavity_sentences(repaired.report.voids, options, repaired.report.after.volume_mm3))
        body.warnings.push_back(named_warning("cavity", said));
}

/// "left, front, below": in which third of the box it lies. A picture has its height along y.
std::string words_for_place(const Eigen::Vector3d& at, const Eigen::AlignedBox3d& box, bool is_picture) {
    constexpr std::array<std::array<const char*, 2>, 3> words{
        {{"left", "right"}, {"front", "back"}, {"below", "above"}}};
    std::string text;
    for (int axis = 0; axis < (is_picture ? 2 : 3); ++axis) {
        const double share = (at[axis] - box.min()[axis]) / std::max(box.sizes()[axis], 1e-9);
        if (share > 1.0 / 3 && share < 2.0 / 3) continue;
        text += (text.empty() ? "" : ", ") +
                std::string(words[std::size_t(is_picture ? 2 * axis : axis)][share > 0.5 ? 1 : 0]);
    }
    return text.empty() ? "in the middle" : text;
}

std::string wall_text(const ThinWall& wall, const JobBody& body, const Eigen::AlignedBox3d& box) {
    const io::TexturedMesh& mesh = body.model.mesh;
    const std::string& name = mesh.materials[mesh.material_of_triangle[wall.source_triangle]].name;
    return fmt::format(
        "{:.2g} mm over {:.3g} mm {} ({:.1f}, {:.1f}, {:.1f} mm{})", wall.thickness_mm, wall.length_mm,
        words_for_place(wall.middle_mm, box, body.is_picture), wall.middle_mm.x(), wall.middle_mm.y(),
        wall.middle_mm.z(),
        !body.is_picture && mesh.materials.size() > 1 && !name.empty() ? ", material " + printable(name) : "");
}

/// Throws InputError for sheets that would be thicker than the model is large: they would be all of it.
void check_sheets(const ResolvedJob& job, const Placement& placement) {
    const double largest_mm = placement.extent_mm.maxCoeff();
    if (job.is_picture() || job.sheet_mm <= largest_mm) return;
    throw InputError(
        fmt::format("--sheet-thickness {:g}mm: the model is {:.3g} mm large, so that its sheets would be "
                    "thicker than they are wide; give less, or a larger --size",
                    job.sheet_mm, largest_mm));
}

/// Throws InputError for a coat from either side that leaves no room for colour.
void check_coat(const ResolvedJob& job, const Placement& placement) {
    const double thin_mm = placement.extent_mm.minCoeff();
    if (job.is_picture() || !job.shows_colours() || job.colour.coat_mm <= 0 || job.colour.coat_mm < thin_mm / 2) return;
    throw InputError(fmt::format(
        "--coat {:g}mm: the model is {:.3g} mm thick at the most along one axis, so that coats from either side leave "
        "nothing for colour; give less than {:.3g} mm, or a larger --size",
        job.colour.coat_mm, thin_mm, thin_mm / 2));
}

/// What may break when the support is washed off, by name and place.
void look_for_thin_walls(const PrinterProfile& printer, const SolidIndex& solid, JobBody& body,
                         const Progress& progress) {
    const double limit_mm = printer.min_wall_mm;
    // What is cut out of a picture may be thin between its sides, which have no colour.
    const VisibleSurface sides = body.is_picture ? picture_surface(body.model.mesh, true) : VisibleSurface();
    const VisibleSurface& surface = body.is_picture ? sides : *body.surface;
    const std::vector<ThinWall> walls = find_thin_walls(surface, solid, limit_mm, progress);
    const Eigen::AlignedBox3d box = bounding_box(solid->positions_mm, solid->triangles);
    if (const auto joints = bare_joints(*solid, limit_mm); !joints.empty() && !body.is_picture)
        body.warnings.push_back(named_warning(
            "fragile",
            fmt::format("{} meet in a point or an edge alone, {} ({:.1f}, {:.1f}, {:.1f} mm): they come apart when "
                        "the support is washed off; let them overlap by {:g} mm in a mesh editor",
                        joints.size() == 1 ? "two pieces" : fmt::format("{} pairs of pieces", joints.size()),
                        words_for_place(joints[0], box, false), joints[0].x(), joints[0].y(), joints[0].z(),
                        limit_mm)));
    if (walls.empty()) return;
    constexpr std::size_t most_told = 4;
    std::string told;
    for (std::size_t w = 0; w < std::min(most_told, walls.size()); ++w)
        told += (w > 0 ? "; " : "") + wall_text(walls[w], body, box);
    if (walls.size() > most_told) told += fmt::format("; and {} more", walls.size() - most_told);
    const std::optional<double> times = larger_without_thin_walls(surface, solid, limit_mm, progress);
    body.warnings.push_back(named_warning(
        fragile_warning,
        fmt::format("walls under {:g} mm, which {} asks for at least, may break when the support is washed "
                    "off: {}. {}{}, they would not",
                    limit_mm, printer.name, told,
                    times ? fmt::format("{:g} times as large, or ", *times) : "If they are ",
                    body.is_picture ? "wider in the picture (--thickness where the slab itself is thin)"
                                    : "thickened in a mesh editor")));
}

/// Where letters are raised the body is larger than its mesh.
void mark_body(const ResolvedJob& job, const PrinterProfile& printer, const SolidIndex& solid, JobBody& body) {
    if (job.marks.empty()) return;
    const LaidMarks laid = lay_marks(
        job.marks, {body.model.mesh, solid, body.surface, body.is_picture, printer.sliced_pitch_mm().minCoeff()},
        job.reading);
    append(body.notes, laid.notes);
    append(body.warnings, laid.warnings);
    for (const MarkOptions& mark : job.marks) body.resin_of_decal.push_back(mark.resin);
    if (laid.embossed.empty()) return;
    const Eigen::Vector3d pitch_mm = printer.sliced_pitch_mm();
    const Eigen::AlignedBox3d raised = box_of_raised(laid.embossed, pitch_mm);
    if (!raised.isEmpty()) {
        const Eigen::AlignedBox3d box = bounding_box(solid->positions_mm, solid->triangles).merged(raised);
        body.grid = grid_around(box.min(), box.max(), pitch_mm);
        check_tray(body.grid, printer.sliced_tray_mm(), body.placement);
    }
    body.relief = relief_of(laid.embossed, body.grid, job.colour.depth_mm + job.colour.clear_over_mm());
}

/// A drawing that lies on its back has nothing finer than the pitch of layers' pixels.
io::DrawingRaster raster_of_picture(const ResolvedJob& job) {
    const Eigen::Vector3d pitch_mm = find_printer(job.printer).sliced_pitch_mm();
    const bool lies = job.placement.rotation.isIdentity(0);
    const PictureOptions& o = job.picture;
    return {lies ? pitch_mm.head<2>().minCoeff() : pitch_mm.minCoeff(), o.width_mm, o.height_mm, o.size_mm, o.dpi};
}

void say_if_lying(const ResolvedJob& job, JobBody& body) {
    const auto& positions = body.model.mesh.positions;
    const auto say = [&](const char* why, const char* turn) {
        body.notes.push_back(
            fmt::format("{} stands on its {}: it is printed lying. To stand it up: --rotate {}", job.model, why, turn));
    };
    if (job.placement.rotation != Eigen::Matrix3d::Identity()) return;
    if (body.model.format == "OBJ" && looks_y_up(positions))
        say("y axis, as most OBJ files do, and a printer's z axis points up", "x90");
    if (body.model.format == "VRML" && looks_z_up_before(positions))
        say("z axis, and the y axis of VRML points up", "x-90");
}

}  // namespace

void check_model(const ResolvedJob& job) {
    if (std::error_code none; std::filesystem::is_directory(job.model, none))
        throw InputError(fmt::format("{}: a folder, not a model; name the file itself", job.model));
}

/// What has no picture's name may be a model that cannot be read.
io::Picture read_input_picture(const ResolvedJob& job, const Progress& progress) {
    io::ReadOptions reading = job.reading;
    reading.progress = &progress;
    reading.drawing = raster_of_picture(job);
    try {
        return io::read_picture(job.model, reading,
                                job.picture.cut_out      ? io::PictureAlpha::cut
                                : job.reading.keep_alpha ? io::PictureAlpha::kept
                                                         : io::PictureAlpha::over_white);
    } catch (const InputError& error) {
        if (io::is_picture_name(job.model)) throw;
        throw InputError(fmt::format("{}; if it is a model, export it as one that can be read ({})", error.what(),
                                     io::model_name_endings));
    }
}

std::shared_ptr<const io::Texture> read_night_picture(const ResolvedJob& job, const Progress& progress) {
    constexpr double most_off = 0.02;
    const auto shape = [](const io::Picture& picture) {
        return picture.width_px / (picture.height_px * picture.pixel_aspect);
    };
    io::ReadOptions reading = job.reading;
    reading.progress = &progress;
    const io::Picture night = io::read_picture(job.picture.night, reading);
    const double day = shape(read_input_picture(job, progress));
    if (std::abs(shape(night) / day - 1) > most_off)
        throw InputError(
            fmt::format("--night {}: is {:.3f} times as wide as high, but the picture for the day is "
                        "{:.3f} times: cut one to the shape of the other",
                        job.picture.night, shape(night), day));
    return night.texture;
}

JobBody read_body(const ResolvedJob& job, Progress& progress) {
    JobBody body;
    const Stopwatch watch;
    progress.begin_stage("read model", 0);
    body.is_picture = job.is_picture();
    io::ModelSources sources;
    body.model = read_input(job, sources, progress);
    body.side_files = std::move(sources.side_files);
    append(body.notes, sources.notes);
    append(body.warnings, body.model.warnings);
    refuse_lost_colour(job, body.model);
    say_if_lying(job, body);
    body.placement = place(body.model, job.placement, job.model);
    if (!body.model.has_colour)
        body.warnings.push_back(named_warning("no-colour", "the model has no colour: it is printed white"));
    constexpr double smallest_plausible_mm = 2;
    if (!body.is_picture && body.placement.extent_mm.maxCoeff() < smallest_plausible_mm)
        body.warnings.push_back(named_warning(
            "tiny", fmt::format("the print is only {:.3g} mm large; if that is not meant, give --unit or --size",
                                body.placement.extent_mm.maxCoeff())));
    body.read_s = watch.total();
    progress.end_stage();
    return body;
}

JobBody prepare_body(const ResolvedJob& job, const PrinterProfile& printer, Progress& progress) {
    JobBody body = read_body(job, progress);
    check_extent(body.placement, printer.sliced_pitch_mm(), printer.sliced_tray_mm());
    check_sheets(job, body.placement);

    progress.begin_stage("repair mesh", repair_steps(body.model.mesh));
    RepairOptions repairing;
    repairing.mode = job.repair;
    repairing.sheet_mm = job.sheet_mm;
    repairing.pitch_mm = printer.sliced_pitch_mm().minCoeff();
    RepairedMesh repaired = repair_mesh(body.model.mesh, repairing, &progress);
    for (const std::string& done : repaired.report.messages) body.warnings.push_back(named_warning("repaired", done));
    if (repaired.solid->triangles.empty())
        throw InputError(
            "the model is a line or a point at this size: no face is left where corners nearer than a tenth of a voxel "
            "are one; a corner far from all others may be a fault of its file, else give a larger --size");
    if (!body.is_picture) look_for_cavities(job, printer, repaired, body, progress);
    progress.end_stage();

    const Eigen::AlignedBox3d box = bounding_box(repaired.solid->positions_mm, repaired.solid->triangles);
    if (job.sheet_mm > 0) body.placement.extent_mm = box.sizes();  // with the thickness that its sheets were given
    check_coat(job, body.placement);
    body.grid = grid_around(box.min(), box.max(), printer.sliced_pitch_mm());
    check_tray(body.grid, printer.sliced_tray_mm(), body.placement);

    progress.begin_stage("find the visible surface", 2 * repaired.solid->triangles.size(), "steps");
    body.surface = SurfaceIndex(coloured_surface_of(body, repaired, progress));
    mark_body(job, printer, repaired.solid, body);
    look_for_colour(job, body);
    look_for_thin_walls(printer, repaired.solid, body, progress);
    progress.end_stage();
    body.repair = std::move(repaired.report);
    body.wrapped_triangles = std::move(repaired.wrapped_triangles);
    body.solid = std::move(repaired.solid);
    return body;
}

void say_body(const JobBody& body, Progress& progress) {
    for (const std::string& warning : body.warnings) progress.warn(warning);
    progress.note(body.placement.summary);
    for (const std::string& note : body.notes) progress.note(note);
}

std::string enough_layers(const JobBody& body) {
    if (body.is_picture) return "thicker (--thickness)";
    const Eigen::Vector3d& extent = body.placement.extent_mm;
    if (extent.z() < 1e-4 * extent.maxCoeff())
        return "thicker (--sheet-thickness), for it is flat, or turn it (--rotate)";
    return "larger (--size), or turn it (--rotate)";
}

VisibleSurface coloured_surface_of(const JobBody& body, const RepairedMesh& repaired, Progress& progress) {
    if (body.is_picture) return picture_surface(body.model.mesh);
    VisibleSurfaceOptions seeing;
    seeing.label_mm = body.grid.pitch_mm.maxCoeff();
    return find_visible_surface(body.model.mesh.positions, body.model.mesh.triangles, repaired, seeing, nullptr,
                                &progress);
}

MeshBoundary boundary_of(const JobBody& body) {
    const Eigen::Vector3d& corner = body.grid.origin_mm;
    // A wrapped body's visible surface is the mesh that the wrap stands for: colours and depths are its own. A
    // picture's is its face alone.
    if (body.is_picture || body.repair.wrapped_faces > 0)
        return {body.solid->positions_mm, body.solid->triangles, corner};
    const PartedSheets parted = part_sheets(body.surface->positions_mm, body.surface->triangles, body.grid.pitch_mm);
    return {parted.positions_mm, parted.triangles, corner};
}

}  // namespace voxtone::slicer

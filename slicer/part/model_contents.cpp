// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/model_contents.h"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/core.h>

#include "io/models/model_reader.h"
#include "io/pictures/picture.h"
#include "slicer/mesh/disjoint_sets.h"
#include "slicer/options/option_values.h"
#include "slicer/options/resolve_job.h"
#include "slicer/part/job_body.h"
#include "slicer/printer/picture_slab.h"

namespace voxtone::slicer {

namespace {

/// Pieces of the mesh that share no corner; corners in one place are one (io/models/mesh.h).
std::size_t pieces_of(const io::TexturedMesh& mesh) {
    DisjointSets sets(mesh.positions.size());
    std::vector<bool> is_used(mesh.positions.size());
    for (const auto& t : mesh.triangles) {
        sets.unite(t[0], t[1]);
        sets.unite(t[0], t[2]);
        for (const std::uint32_t v : t) is_used[v] = true;
    }
    std::size_t pieces = 0;
    for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) pieces += is_used[v] && sets.root(v) == v ? 1 : 0;
    return pieces;
}

void take_materials(const io::TexturedMesh& mesh, ModelContents& contents) {
    std::vector<std::size_t> triangles(mesh.materials.size());
    for (const std::uint32_t material : mesh.material_of_triangle) ++triangles[material];
    std::map<const io::Texture*, std::size_t> known;
    for (std::size_t m = 0; m < mesh.materials.size(); ++m) {
        if (triangles[m] == 0) continue;
        const io::SurfaceMaterial& of = mesh.materials[m];
        ContentsMaterial material{of.name, {of.rgb.x(), of.rgb.y(), of.rgb.z()}, {}, triangles[m]};
        if (of.texture) {
            const auto [entry, is_new] = known.try_emplace(of.texture.get(), contents.textures.size());
            if (is_new) contents.textures.push_back({of.texture->width_px(), of.texture->height_px()});
            material.texture = entry->second;
        }
        contents.material_colours = contents.material_colours || !of.rgb.isOnes(0);
        contents.materials.push_back(std::move(material));
    }
    const auto is_coloured = [](const auto& corners) {
        return std::ranges::any_of(corners, [](const Eigen::Vector3f& rgb) { return !rgb.isOnes(0); });
    };
    contents.vertex_colours = std::ranges::any_of(mesh.corner_rgb, is_coloured);
}

/// As far as can be told before it is repaired.
void take_size(const ResolvedJob& job, const Placement& placement, ModelContents& contents) {
    const Eigen::Vector3d& mm = placement.extent_mm;
    contents.size_mm = {mm.x(), mm.y(), mm.z()};
    const PrinterProfile printer = find_printer(job.printer);
    try {
        check_extent(placement, printer.sliced_pitch_mm(), printer.sliced_tray_mm());
    } catch (const InputError& error) {
        contents.refused = error.what();
    }
}

void read_picture_file(ResolvedJob& job, Progress& progress, ModelContents& contents, const MeshViewer& view) {
    contents.format = "picture";
    const io::Picture picture = read_input_picture(job, progress);
    contents.picture_px = {picture.width_px, picture.height_px};
    contents.dpi = picture.dpi_x;
    contents.warnings = picture.warnings;
    if (!(picture.dpi_x > 0) && !is_sized(job.picture)) {
        contents.notes.emplace_back("the picture says nothing about its size: give --width, --height, --size or --dpi");
        constexpr double any_width_mm = 100;
        job.picture.width_mm = any_width_mm;
        if (view) view(make_picture_slab(picture, job.picture).model.mesh, true);
        return;
    }
    contents.unit_is = is_sized(job.picture) ? "asked" : "file";
    PictureSlab slab = make_picture_slab(picture, job.picture);
    contents.notes = slab.notes;
    take_size(job, place(slab.model, job.placement, job.model), contents);
    if (view) view(slab.model.mesh, true);
}

void read_model_file(const ResolvedJob& job, Progress& progress, ModelContents& contents, const MeshViewer& view) {
    const JobBody body = read_body(job, progress);
    contents.format = body.model.format;
    contents.unit_is = body.placement.unit_assumed ? "assumed" : job.placement.unit ? "asked" : "file";
    contents.mm_per_unit = body.placement.mm_per_file_unit;
    contents.triangles = body.model.mesh.triangles.size();
    contents.vertices = body.model.mesh.positions.size();
    contents.parts = pieces_of(body.model.mesh);
    take_materials(body.model.mesh, contents);
    contents.side_files = body.side_files;
    contents.warnings = body.warnings;
    contents.notes = body.notes;
    take_size(job, body.placement, contents);
    if (view) view(body.model.mesh, false);
}

}  // namespace

ModelContents read_contents(const SliceOptions& options, Progress& progress, const MeshViewer& view) {
    ModelContents contents;
    contents.file = options.model;
    try {
        ResolvedJob job = resolve(options);
        if (job.kind == ModelKind::tray_plan)
            throw InputError(
                fmt::format("{}: a plan, and no model; `voxtone estimate` tells what is in it", options.model));
        check_model(job);
        if (job.is_picture())
            read_picture_file(job, progress, contents, view);
        else
            read_model_file(job, progress, contents, view);
    } catch (const UsageError&) {
        throw;
    } catch (const Error& error) {
        contents.error = error.what();
        contents.exit_code = error.exit_code();
    }
    return contents;
}

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/proof/proof_print.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/core.h>

#include "base/error.h"
#include "base/warning.h"
#include "optics/colour/channels.h"
#include "optics/layered/layered_appearance.h"
#include "slicer/look/cell_mesh.h"
#include "slicer/look/support_contact.h"
#include "slicer/look/vertex_colours.h"
#include "slicer/mesh/parted_sheets.h"
#include "slicer/proof/solid_boxes.h"
#include "slicer/surface/surface_colour.h"

namespace voxtone::slicer {

namespace {

using Eigen::Vector3d;

Box box_of(const StackVolume& stack) {
    const auto& size = stack.volume.size();
    const Vector3d low = vector_of(stack.corner_mm);
    return {low, low + Vector3d(size[0], size[1], size[2]).cwiseProduct(vector_of(stack.volume.pitch_mm()))};
}

/// Outward.
void add_box(const Box& box, const Eigen::Vector3f& rgb, io::ColouredMesh& mesh) {
    const auto first = static_cast<std::uint32_t>(mesh.positions_mm.size());
    for (int corner = 0; corner < 8; ++corner) mesh.positions_mm.push_back(corner_of(box, corner).cast<float>());
    mesh.rgb.insert(mesh.rgb.end(), 8, rgb);
    constexpr std::array<std::array<std::uint32_t, 3>, 12> triangles{{{0, 2, 1},
                                                                      {1, 2, 3},
                                                                      {4, 5, 6},
                                                                      {5, 7, 6},
                                                                      {0, 1, 4},
                                                                      {1, 5, 4},
                                                                      {2, 6, 3},
                                                                      {3, 6, 7},
                                                                      {0, 4, 2},
                                                                      {2, 4, 6},
                                                                      {1, 3, 5},
                                                                      {3, 7, 5}}};
    for (const auto& [a, b, c] : triangles) mesh.triangles.push_back({first + a, first + b, first + c});
}
io::ColouredMesh box_mesh(const Box& box, const Eigen::Vector3f& rgb) {
    io::ColouredMesh mesh;
    add_box(box, rgb, mesh);
    return mesh;
}

/// A picture's slab that is cut to shape is no box.
bool fills_its_box(const optics::ResinVolume& volume) {
    const auto& [nx, ny, nz] = volume.size();
    for (int y = 0; y < ny; ++y)
        for (int x = 0; x < nx; ++x)
            if (volume.at(x, y, nz / 2) == 0) return false;
    return true;
}

/// A picture's slab in white, whose top lies a little below its coloured face.
io::ColouredMesh slab_below(const ProofPrint& print, const SolidMesh& solid) {
    constexpr double below_mm = 0.01;
    if (fills_its_box(print.stack.volume)) {
        Box slab = print.box;
        slab.high.z() -= below_mm;
        return box_mesh(slab, Eigen::Vector3f::Ones());
    }
    io::ColouredMesh mesh;
    double top_mm = -std::numeric_limits<double>::infinity();
    for (const Vector3d& p : solid.positions_mm) top_mm = std::max(top_mm, p.z());
    for (const Vector3d& p : solid.positions_mm)
        mesh.positions_mm.push_back(Vector3d(p.x(), p.y(), std::min(p.z(), top_mm - below_mm)).cast<float>());
    mesh.rgb.assign(mesh.positions_mm.size(), Eigen::Vector3f::Ones());
    mesh.triangles = solid.triangles;
    return mesh;
}

MeshBoundary boundary_of(const io::ColouredMesh& mesh, const Vector3d& corner) {
    std::vector<Vector3d> positions;
    for (const Eigen::Vector3f& p : mesh.positions_mm) positions.push_back(p.cast<double>());
    return {positions, mesh.triangles, corner};
}

/// Of stacks that do not know their model: through the middles of the surface cells of about 0.1 mm.
MeshBoundary cells_boundary(const optics::Scene& scene, const Progress& progress) {
    const optics::ResinVolume& volume = *scene.volume;
    const optics::Surface surface =
        optics::find_surface(scene, optics::cell_voxels(volume.pitch_mm(), 0.1), optics::SurfacePart::all, &progress);
    std::vector<Vector3d> positions;
    for (const optics::SurfaceCell& cell : surface.cells)
        positions.emplace_back(cell.centre_mm[0], cell.centre_mm[1], cell.centre_mm[2]);
    const auto triangles = cell_triangles(volume, surface);
    if (triangles.empty())
        throw InputError("the stack's body is not larger than a tenth of a mm: there is no surface to look at");
    return {positions, triangles, Vector3d::Zero(), std::numbers::pi};
}

/// What a thick layer of the white resin sends back of the light that falls on it, mirror reflection left out: a target
/// of colour 1 is taken for that, as the print is.
Vector3d paper_white(const StackVolume& stack) {
    if (stack.white < 0) return Vector3d::Ones();
    const optics::ResinSet& set = stack.resins;
    const optics::OrdinatePlan plan = optics::appearance_plan(set.g, set.eta);
    const Eigen::Matrix3Xd weights = optics::linear_srgb_weights(set.channels);
    Vector3d white = Vector3d::Zero();
    for (std::size_t c = 0; c < set.channels.size(); ++c) {
        const double seen = optics::appearance(
            plan, optics::half_space(plan, set.resins[static_cast<std::size_t>(stack.white)].medium(c)));
        white += weights.col(static_cast<Eigen::Index>(c)) * seen;
    }
    return white;
}

/// `parted`: of the body's surface; a sheet's rim has the colour of the face that it goes along.
ColouredSurface target_of(const JobBody& body, const PartedSheets& parted, const SurfaceColour& requested) {
    ColouredSurface out;
    out.positions_mm = parted.positions_mm;
    out.triangles = parted.triangles;
    out.colour = [&surface = *body.surface, &parted, &requested](std::uint32_t t, float u, float v) {
        if (t >= surface.triangles.size()) t = parted.rim_of[t - surface.triangles.size()];
        const auto& corner = surface.source_uv[t];
        const Eigen::Vector2f at = (1 - u - v) * corner[0] + u * corner[1] + v * corner[2];
        return requested.at(surface.source_triangle[t], at.x(), at.y());
    };
    return out;
}

void find_surface_of(ProofPrint& print, Progress& progress) {
    const auto& body = print.body.body;
    const bool of_picture = print.stack.of_picture || (body && body->is_picture);
    if (of_picture && fills_its_box(print.stack.volume)) {
        print.boundary.emplace(
            boundary_of(box_mesh(print.box, Eigen::Vector3f::Ones()), vector_of(print.stack.corner_mm)));
        print.boundary_is = "box";
        print.boxes = {{Vector3d::Zero(), print.box.high - print.box.low}};
    } else if (body && body->relief.empty()) {
        print.boundary.emplace(boundary_of(*body));
        print.boundary_is = "mesh";
    } else if (!body && !(print.boxes = solid_boxes(print.stack.volume)).empty()) {
        io::ColouredMesh mesh;
        for (const Box& box : print.boxes) add_box(box, Eigen::Vector3f::Ones(), mesh);
        print.boundary.emplace(boundary_of(mesh, Vector3d::Zero()));
        print.boundary_is = "box";
    } else {
        progress.warn(named_warning("voxel-surface",
                                    fmt::format("the surface is that of the voxels, smoothed, and not the mesh: {}",
                                                body ? "its labels are raised or engraved" : print.body.why_not)));
        print.boundary.emplace(cells_boundary(print.scene, progress));
        print.boundary_is = "cells";
    }
}

/// Of one stack's volume: light paths need twice as much besides (two bytes a voxel where it has one).
std::uint64_t volume_bytes(const ResolvedProof& job) { return job.memory_bytes / (4 * job.requested.stacks.size()); }

}  // namespace

std::unique_ptr<ProofPrint> make_print(const ResolvedProof& job, const std::string& stack, Progress& progress) {
    auto made = std::make_unique<ProofPrint>();
    ProofPrint& print = *made;
    print.stack = read_stack_volume({.stack = stack,
                                     .resins = job.requested.resins,
                                     .illuminant = job.requested.illuminant,
                                     .printer = job.requested.printer,
                                     .pitch_mm = job.pitch_mm,
                                     .assign = job.assign,
                                     .nearest = job.requested.nearest,
                                     .memory_bytes = volume_bytes(job)},
                                    progress);
    print.scene = {.volume = &print.stack.volume, .resins = &print.stack.resins, .spread_mm = print.stack.spread_mm};
    print.box = box_of(print.stack);
    print.body = body_of_stack(stack, print.stack, progress);
    find_surface_of(print, progress);
    const auto& rough = job.requested.roughness;
    if (job.finish == ProofFinish::matt)
        print.finish = std::make_unique<optics::EvenFinish>(rough[1]);
    else
        print.finish = std::make_unique<SupportContact>(print.stack.volume, rough[0], rough[1]);
    return made;
}

std::vector<std::unique_ptr<const DiffuseMesh>> make_target(const ProofPrint& print, const Vector3d& moved_mm,
                                                            Progress& progress) {
    if (!print.body.body)
        throw InputError(fmt::format("--with-target: the model cannot be had: {}; leave it out, or slice again",
                                     print.body.why_not));
    const JobBody& body = *print.body.body;
    progress.begin_stage("colour the target", 0);
    constexpr double spacing_mm = 0.1;
    const SurfaceColour requested(body.model.mesh, spacing_mm);
    const PartedSheets parted = part_sheets(body.surface->positions_mm, body.surface->triangles, body.grid.pitch_mm);
    const VertexColours colours = vertex_colours(target_of(body, parted, requested),
                                                 {.edge_mm = 2 * spacing_mm, .max_vertices = 3'000'000}, &progress);
    const Vector3d white = paper_white(print.stack);
    const DiffuseMesh::Gloss gloss{print.stack.resins.eta, print.finish.get(),
                                   vector_of(print.stack.corner_mm) + moved_mm};
    std::vector<std::unique_ptr<const DiffuseMesh>> parts;
    parts.push_back(std::make_unique<const DiffuseMesh>(colours.mesh, moved_mm, white, gloss));
    if (body.is_picture)  // its coloured surface is a sheet: the slab below it
        parts.push_back(std::make_unique<const DiffuseMesh>(slab_below(print, *body.solid), moved_mm, white, gloss));
    progress.end_stage();
    return parts;
}

}  // namespace voxtone::slicer

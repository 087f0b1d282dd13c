// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/proof/proof_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/core.h>
#include <Eigen/Geometry>

#include "voxtone/base/error.h"
#include "voxtone/optics/colour/spectral_colour.h"
#include "voxtone/optics/layered/layered_appearance.h"
#include "voxtone/slicer/look/cell_mesh.h"
#include "voxtone/slicer/look/vertex_colours.h"
#include "voxtone/slicer/predict/stack_boundary.h"
#include "voxtone/slicer/proof/proof_light.h"
#include "voxtone/slicer/surface/surface_colour.h"

namespace voxtone::slicer {

namespace {

using Eigen::Vector3d;

Vector3d three(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }
optics::Point point(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

struct Box {
    Vector3d low, high;
};

/// The room that a print stands in, by its axes in the model's frame: x to the right and z up before the front view.
Eigen::Matrix3d room_axes(ProofUp up, double turn_deg) {
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // rows: the room's x, y and z
    switch (up) {
        case ProofUp::z:
            break;
        case ProofUp::minus_z:
            axes << 1, 0, 0, 0, -1, 0, 0, 0, -1;
            break;
        case ProofUp::y:
            axes << 1, 0, 0, 0, 0, -1, 0, 1, 0;
            break;
        case ProofUp::minus_y:
            axes << 1, 0, 0, 0, 0, 1, 0, -1, 0;
            break;
        case ProofUp::x:
            axes << 0, 0, -1, 0, 1, 0, 1, 0, 0;
            break;
        case ProofUp::minus_x:
            axes << 0, 0, 1, 0, 1, 0, -1, 0, 0;
            break;
    }
    return Eigen::AngleAxisd(turn_deg * std::numbers::pi / 180, Vector3d::UnitZ()) * axes;
}

Vector3d corner_of(const Box& box, int corner) {
    return {corner & 1 ? box.high.x() : box.low.x(), corner & 2 ? box.high.y() : box.low.y(),
            corner & 4 ? box.high.z() : box.low.z()};
}

/// What holds a turned box.
Box turned(const Eigen::Matrix3d& turn, const Box& box) {
    Box held{turn * box.low, turn * box.low};
    for (int corner = 1; corner < 8; ++corner) {
        const Vector3d p = turn * corner_of(box, corner);
        held = {held.low.cwiseMin(p), held.high.cwiseMax(p)};
    }
    return held;
}
Box box_of(const StackVolume& stack) {
    const auto& size = stack.volume.size();
    const Vector3d low = three(stack.corner_mm);
    return {low, low + Vector3d(size[0], size[1], size[2]).cwiseProduct(three(stack.volume.pitch_mm()))};
}

/// Outward.
io::ColouredMesh box_mesh(const Box& box, const Eigen::Vector3f& rgb) {
    io::ColouredMesh mesh;
    for (int corner = 0; corner < 8; ++corner) mesh.positions_mm.push_back(corner_of(box, corner).cast<float>());
    mesh.rgb.assign(8, rgb);
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
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
    const Eigen::Matrix3Xd weights = optics::linear_srgb_weights(set.channels.wavelengths_nm);
    Vector3d white = Vector3d::Zero();
    for (std::size_t c = 0; c < set.channels.size(); ++c) {
        const double seen = optics::appearance(
            plan, optics::half_space(plan, set.resins[static_cast<std::size_t>(stack.white)].medium(c)));
        white += weights.col(static_cast<Eigen::Index>(c)) * seen;
    }
    return white;
}

ColouredSurface target_of(const JobBody& body, const SurfaceColour& asked) {
    ColouredSurface out;
    out.positions_mm = body.surface->positions_mm;
    out.triangles = body.surface->triangles;
    out.colour = [&surface = *body.surface, &asked](std::uint32_t t, float u, float v) {
        const auto& corner = surface.source_uv[t];
        const Eigen::Vector2f at = (1 - u - v) * corner[0] + u * corner[1] + v * corner[2];
        return asked.at(surface.source_triangle[t], at.x(), at.y());
    };
    return out;
}

/// Moved so far, in the model's frame.
void add_target(const JobBody& body, const Box& box, const Vector3d& moved, ProofScene& scene, Progress& progress) {
    progress.begin_stage("colour the target", 0);
    constexpr double spacing_mm = 0.1;
    const SurfaceColour asked(body.model.mesh, spacing_mm);
    const VertexColours colours =
        vertex_colours(target_of(body, asked), {.edge_mm = 2 * spacing_mm, .max_vertices = 3'000'000}, &progress);
    const Vector3d white = paper_white(scene.stack);
    scene.target.push_back(std::make_unique<const DiffuseMesh>(colours.mesh, moved, white));
    if (body.is_picture) {  // its coloured surface is a sheet: the slab below it
        Box slab = box;
        slab.high.z() -= 0.01;
        scene.target.push_back(
            std::make_unique<const DiffuseMesh>(box_mesh(slab, Eigen::Vector3f::Ones()), moved, white));
    }
    progress.end_stage();
}

struct Direction {
    double azimuth_deg, height_deg;
};
/// Where the camera stands, seen from the body.
Direction stand_of(ProofView view) {
    switch (view) {
        case ProofView::three_quarter:
            return {-62, 24};
        case ProofView::front:
            return {-90, 9};
        case ProofView::right:
            return {0, 9};
        case ProofView::back:
            return {90, 9};
        case ProofView::left:
            return {180, 9};
        case ProofView::top:
            return {-90, 90};
        case ProofView::bottom:
            return {-90, -90};
    }
    return {};
}

/// So far off that the box just fits the picture.
double fitting_distance(const ResolvedProof& job, const Box& box, const Vector3d& from) {
    const Vector3d middle = 0.5 * (box.low + box.high), back = from.normalized();
    Vector3d right = Vector3d::UnitZ().cross(back);
    if (right.norm() < 1e-6) right = Vector3d::UnitX();
    right.normalize();
    const Vector3d up = back.cross(right);
    constexpr double margin = 1.12;
    const double half_width = 0.5 * optics::film_width_mm / job.asked.focal_mm,
                 half_height = half_width * job.height_px / job.width_px;
    double distance = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const Vector3d p = corner_of(box, corner) - middle;
        const double across = std::max(std::abs(p.dot(right)) / half_width, std::abs(p.dot(up)) / half_height);
        distance = std::max(distance, margin * across + p.dot(back));
    }
    return distance;
}

/// `room`: what it looks at, in the room's frame; `axes` of the room.
void place_camera(const ResolvedProof& job, const Box& room, const Eigen::Matrix3d& axes, bool flat,
                  optics::CameraView& view) {
    const Eigen::Matrix3d to_model = axes.transpose();
    view.target = job.look_at.value_or(point(to_model * (0.5 * (room.low + room.high))));
    view.focal_mm = job.asked.focal_mm;
    view.width_px = job.width_px;
    view.height_px = job.height_px;
    const Direction stand = stand_of(job.view.value_or(flat ? ProofView::top : ProofView::three_quarter));
    const double a = stand.azimuth_deg * std::numbers::pi / 180, h = stand.height_deg * std::numbers::pi / 180;
    const Vector3d from(std::cos(h) * std::cos(a), std::cos(h) * std::sin(a), std::sin(h));
    view.position =
        job.camera.value_or(point(three(view.target) + fitting_distance(job, room, from) * (to_model * from)));
    const Vector3d ahead = axes * (three(view.target) - three(view.position));
    const bool straight = ahead.cross(Vector3d::UnitZ()).norm() < 1e-6 * ahead.norm();
    view.up = point(to_model * (straight ? Vector3d::UnitY() : Vector3d::UnitZ()));
}

}  // namespace

std::unique_ptr<const ProofScene> make_proof_scene(const ResolvedProof& job, Progress& progress) {
    auto made = std::make_unique<ProofScene>();
    ProofScene& s = *made;
    s.sky = light_of(job, progress);
    s.stack = read_stack_volume({.stack = job.asked.stack,
                                 .resins = job.asked.resins,
                                 .printer = job.asked.printer,
                                 .pitch_mm = job.pitch_mm,
                                 .assign = job.assign,
                                 .memory_bytes = job.memory_bytes / 2},
                                progress);
    s.scene = {.volume = &s.stack.volume, .resins = &s.stack.resins};
    const Box box = box_of(s.stack);
    StackBody found = body_of_stack(job.asked.stack, s.stack, progress);
    if (job.asked.with_target && !found.body)
        throw InputError(
            fmt::format("--with-target: the model cannot be had: {}; leave it out, or slice again", found.why_not));
    if (s.stack.of_picture || (found.body && found.body->is_picture)) {
        s.boundary.emplace(boundary_of(box_mesh(box, Eigen::Vector3f::Ones()), three(s.stack.corner_mm)));
        s.boundary_is = "box";
    } else if (found.body) {
        s.boundary.emplace(boundary_of(*found.body));
        s.boundary_is = "mesh";
    } else {
        progress.warn(fmt::format("the surface is that of the voxels, smoothed, and not the mesh: {}", found.why_not));
        s.boundary.emplace(cells_boundary(s.scene, progress));
        s.boundary_is = "cells";
    }
    const auto& rough = job.asked.roughness;
    if (job.finish == ProofFinish::matt)
        s.finish = std::make_unique<optics::EvenFinish>(rough[1]);
    else
        s.finish = std::make_unique<SupportContact>(s.stack.volume, rough[0], rough[1]);
    s.camera.sky = &s.sky;
    s.camera.prints.push_back({&s.scene, &*s.boundary, s.finish.get(), s.stack.corner_mm});
    const Eigen::Matrix3d axes = room_axes(job.up, job.asked.turn_deg);
    Box room = turned(axes, box);
    for (std::size_t k = 0; k < 3; ++k) s.camera.sky_axes[k] = point(axes.row(static_cast<Eigen::Index>(k)));
    // What lies on the ground touches it here and there only.
    constexpr double gap_mm = 0.01;
    if (job.ground && job.view != ProofView::bottom)
        s.camera.ground =
            optics::Ground{s.camera.sky_axes[2], room.low.z() - gap_mm, {*job.ground, *job.ground, *job.ground}};
    if (job.asked.with_target) {
        const double aside = room.high.x() - room.low.x() + 0.12 * (room.high - room.low).maxCoeff();
        add_target(*found.body, box, axes.transpose() * Vector3d(aside, 0, 0), s, progress);
        room.high.x() += aside;
    }
    for (const auto& body : s.target) s.camera.diffusers.push_back(body.get());
    place_camera(job, room, axes, s.stack.of_picture, s.camera.view);
    return made;
}

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/joined_body.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "base/contracts.h"
#include "slicer/mesh/box.h"
#include "slicer/surface/touching_walls.h"

namespace voxtone::slicer {

namespace {

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
    to.insert(to.end(), from.begin(), from.end());
}

void append_moved(std::vector<Eigen::Vector3d>& to, const std::vector<Eigen::Vector3d>& from,
                  const Eigen::Vector3d& shift) {
    for (const Eigen::Vector3d& position : from) to.emplace_back(position + shift);
}

void append_triangles(std::vector<std::array<std::uint32_t, 3>>& to,
                      const std::vector<std::array<std::uint32_t, 3>>& from, std::size_t first_corner) {
    const auto first = static_cast<std::uint32_t>(first_corner);
    for (const auto& [a, b, c] : from) to.push_back({a + first, b + first, c + first});
}

/// Lists that only some meshes have: those that lack one get what changes nothing.
template <class T>
void append_or_fill(std::vector<std::array<T, 3>>& to, const std::vector<std::array<T, 3>>& from, std::size_t before,
                    std::size_t triangles, const T& neutral) {
    if (to.empty() && from.empty()) return;
    const std::array<T, 3> filling{neutral, neutral, neutral};
    to.resize(before, filling);
    append(to, from);
    to.resize(before + triangles, filling);
}

Eigen::Vector3d shift_of(const BodyAt& one, const Eigen::Vector3d& pitch_mm) {
    return Eigen::Vector3d(one.at[0], one.at[1], one.at[2]).cwiseProduct(pitch_mm) - one.body->grid.origin_mm;
}

void append_mesh(io::TexturedMesh& to, const io::TexturedMesh& from, const Eigen::Vector3d& shift) {
    const std::size_t before = to.triangles.size();
    append_triangles(to.triangles, from.triangles, to.positions.size());
    append_moved(to.positions, from.positions, shift);
    for (const std::uint32_t material : from.material_of_triangle)
        to.material_of_triangle.push_back(material + static_cast<std::uint32_t>(to.materials.size()));
    append_or_fill<Eigen::Vector2f>(to.corner_uv, from.corner_uv, before, from.triangles.size(),
                                    Eigen::Vector2f::Zero());
    append_or_fill<Eigen::Vector3f>(to.corner_rgb, from.corner_rgb, before, from.triangles.size(),
                                    Eigen::Vector3f::Ones());
    append_or_fill<float>(to.corner_alpha, from.corner_alpha, before, from.triangles.size(), 1);
    append(to.materials, from.materials);
    for (io::Decal decal : from.decals) {
        decal.corner_mm += shift;
        to.decals.push_back(std::move(decal));
    }
}

template <class Run>
void append_runs(std::vector<Run>& to, const std::vector<Run>& from, const std::array<int, 3>& at) {
    for (Run run : from) {
        run.k += at[2], run.j += at[1];
        run.begin += at[0], run.end += at[0];
        to.push_back(run);
    }
}

void append_solid(SolidMesh& to, const SolidMesh& from, const Eigen::Vector3d& shift, std::size_t first_source) {
    append_triangles(to.triangles, from.triangles, to.positions_mm.size());
    append_moved(to.positions_mm, from.positions_mm, shift);
    for (const std::int32_t source : from.source_triangle)
        to.source_triangle.push_back(source < 0 ? source : source + static_cast<std::int32_t>(first_source));
}

void add_to(RepairReport& sum, const RepairReport& one) {
    sum.welded_vertices += one.welded_vertices;
    sum.dropped_faces += one.dropped_faces;
    sum.turned_faces += one.turned_faces;
    sum.turned_shells += one.turned_shells;
    sum.cavities += one.cavities;
    sum.filled_holes += one.filled_holes;
    sum.filled_area_mm2 += one.filled_area_mm2;
    sum.wrapped_faces += one.wrapped_faces;
    sum.wrap_alpha_mm = std::max(sum.wrap_alpha_mm, one.wrap_alpha_mm);
    sum.wrap_offset_mm = std::max(sum.wrap_offset_mm, one.wrap_offset_mm);
    append(sum.voids, one.voids);
}

/// Where each body lies in the whole, for what of their walls touches.
void drop_walls(std::span<const BodyAt> bodies, const std::vector<std::uint32_t>& first_sources, const JobBody& whole,
                VisibleSurface& surface) {
    std::vector<SolidIndex> solids;
    std::vector<BodyOfSurface> of_surface;
    solids.reserve(bodies.size());
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        SolidMesh moved;
        append_solid(moved, *bodies[b].body->solid, shift_of(bodies[b], whole.grid.pitch_mm), 0);
        solids.emplace_back(std::move(moved));
        const std::size_t end = b + 1 < bodies.size() ? first_sources[b + 1] : whole.model.mesh.triangles.size();
        of_surface.push_back({&solids.back().tree(), first_sources[b], static_cast<std::uint32_t>(end)});
    }
    drop_touching_walls(surface, of_surface, whole.grid.pitch_mm.maxCoeff());
}

}  // namespace

JobBody join_bodies(std::span<const BodyAt> bodies, Progress& progress) {
    VOXTONE_EXPECT(!bodies.empty());
    JobBody whole;
    RepairedMesh repaired;
    SolidMesh solid;
    std::vector<std::uint32_t> first_sources;
    std::vector<ReliefRun> relief;
    std::vector<DepthRun> depths;
    whole.model.format = bodies[0].body->model.format;
    whole.grid.pitch_mm = bodies[0].body->grid.pitch_mm;
    whole.grid.size = {};
    for (const BodyAt& one : bodies) {
        const JobBody& body = *one.body;
        VOXTONE_EXPECT(!body.is_picture && body.grid.pitch_mm == whole.grid.pitch_mm);
        const Eigen::Vector3d shift = shift_of(one, whole.grid.pitch_mm);
        const std::size_t first_source = whole.model.mesh.triangles.size();
        first_sources.push_back(static_cast<std::uint32_t>(first_source));
        append_mesh(whole.model.mesh, body.model.mesh, shift);
        append_solid(solid, *body.solid, shift, first_source);
        append(whole.resin_of_decal, body.resin_of_decal);
        append_runs(relief, body.relief.runs(), one.at);
        append_runs(depths, body.relief.depths(), one.at);
        for (const std::uint32_t wrapped : body.wrapped_triangles)
            repaired.wrapped_triangles.push_back(wrapped + static_cast<std::uint32_t>(first_source));
        add_to(repaired.report, body.repair);
        whole.model.has_colour |= body.model.has_colour;
        whole.model.wants_colour |= body.model.wants_colour;
        if (whole.model.lost_colour.empty()) whole.model.lost_colour = body.model.lost_colour;
        for (std::size_t axis = 0; axis < 3; ++axis)
            whole.grid.size[axis] = std::max(whole.grid.size[axis], one.at[axis] + body.grid.size[axis]);
    }
    whole.placement.mm_per_file_unit = 1;
    whole.placement.extent_mm = bounding_box(solid.positions_mm, solid.triangles).sizes();
    whole.placement.summary =
        fmt::format("{} bodies as one of {:.2f} x {:.2f} x {:.2f} mm", bodies.size(), whole.placement.extent_mm.x(),
                    whole.placement.extent_mm.y(), whole.placement.extent_mm.z());
    repaired.report.after = repaired.report.before = diagnose(solid.positions_mm, solid.triangles, nullptr, &progress);
    repaired.solid = SolidIndex(std::move(solid));
    VisibleSurface surface = coloured_surface_of(whole, repaired, progress);
    drop_walls(bodies, first_sources, whole, surface);
    whole.surface = SurfaceIndex(std::move(surface));
    whole.wrapped_triangles = std::move(repaired.wrapped_triangles);
    whole.repair = std::move(repaired.report);
    whole.solid = std::move(repaired.solid);
    whole.relief = Relief(relief, depths);
    return whole;
}

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/estimate/orientations.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include "base/parallel.h"
#include "slicer/mesh/box.h"
#include "slicer/solid/solid.h"
#include "slicer/surface/area_samples.h"
#include "slicer/surface/surface_colour.h"

namespace voxtone::slicer {

namespace {

constexpr std::array up_turns{"", "x90", "x180", "x-90", "y90", "y-90"};
constexpr std::array turns_about_z{"", "z90", "z180", "z-90"};

std::string joined(const std::string& first, const std::string& second) {
    return first.empty() || second.empty() ? first + second : first + "," + second;
}

/// A piece of the visible surface.
struct Piece {
    Eigen::Vector3d normal;
    bool white;
};

/// Pieces of equal area.
std::vector<Piece> pieces_of(const JobBody& body) {
    constexpr std::uint64_t pieces = 50'000, seed = 1;
    constexpr float white_from = 0.9f;  // linear
    std::vector<Piece> found;
    if (body.surface->triangles.empty()) return found;
    const AreaSamples area(*body.surface);
    const SurfaceColour colour(body.model.mesh, std::sqrt(area.area_mm2() / double(pieces)));
    found.resize(pieces);
    parallel_for(0, pieces, 1024, [&](std::size_t i) {
        const AreaSamples::Sample s = area.at(seed, i);
        const auto [a, b, c] = body.surface.tree().corners(s.triangle);
        const auto& place = body.surface->source_uv[s.triangle];
        const Eigen::Vector2f uv = float(1 - s.u - s.v) * place[0] + float(s.u) * place[1] + float(s.v) * place[2];
        const Eigen::Vector3f rgb = colour.at(body.surface->source_triangle[s.triangle], uv.x(), uv.y());
        found[i] = {(b - a).cross(c - a).normalized(), rgb.minCoeff() >= white_from};
    });
    return found;
}

/// Of the mesh as it lies.
double air_under_body_ml(const SolidMesh& mesh) {
    constexpr double voxels_across = 100;
    const Eigen::AlignedBox3d box = bounding_box(mesh.positions_mm, mesh.triangles);
    const double pitch_mm = box.sizes().maxCoeff() / voxels_across;
    const VoxelGrid grid = grid_around(box.min(), box.max(), Eigen::Vector3d::Constant(pitch_mm));
    const SpanSlab slab = Solid(mesh, grid).slab(0, grid.size[2]);
    const auto width = static_cast<std::size_t>(grid.size[0]);
    std::vector<char> covered(width * static_cast<std::size_t>(grid.size[1]), 0);
    std::uint64_t under = 0;
    for (int k = grid.size[2] - 1; k >= 0; --k)
        for (int j = 0; j < grid.size[1]; ++j) {
            char* const row = covered.data() + static_cast<std::size_t>(j) * width;
            int i = 0;
            for (const Span& span : slab.row(j, k)) {
                for (; i < span.begin; ++i) under += static_cast<std::uint64_t>(row[i]);
                for (; i < span.end; ++i) row[i] = 1;
            }
            for (; i < grid.size[0]; ++i) under += static_cast<std::uint64_t>(row[i]);
        }
    return double(under) * grid.voxel_volume_mm3() * 1e-3;
}

/// What is the same however the body is turned about the upright.
void look_from_below(const std::vector<Piece>& pieces, double area_mm2, const SolidMesh& turned,
                     const Eigen::Matrix3d& turn, Orientation& orientation) {
    std::size_t down = 0, coloured = 0;
    for (const Piece& piece : pieces) {
        if (turn.row(2).dot(piece.normal) > -std::numbers::sqrt2 / 2) continue;
        ++down;
        coloured += piece.white ? 0 : 1;
    }
    const double piece_mm2 = pieces.empty() ? 0 : area_mm2 / double(pieces.size());
    orientation.downward_mm2 = double(down) * piece_mm2;
    orientation.coloured_down_mm2 = double(coloured) * piece_mm2;
    orientation.under_ml = air_under_body_ml(turned);
}

SolidMesh turned_mesh(const SolidMesh& mesh, const Eigen::Matrix3d& turn) {
    SolidMesh turned = mesh;
    for (Eigen::Vector3d& position : turned.positions_mm) position = turn * position;
    return turned;
}

void measure(const OpenedJob& job, const Eigen::Vector3d& extent_mm, Orientation& orientation) {
    const Eigen::Vector3d tray_mm = job.printer.sliced_tray_mm();
    const VoxelGrid grid = grid_around(Eigen::Vector3d::Zero(), extent_mm, job.printer.sliced_pitch_mm());
    orientation.size_mm = {extent_mm.x(), extent_mm.y(), extent_mm.z()};
    orientation.layers = grid.size[2];
    orientation.fits = (extent_mm.array() <= tray_mm.array()).all() && grid.size[2] >= job.printer.min_layers;
}

}  // namespace

std::vector<Orientation> orientations(const OpenedJob& job, const JobBody& body, const Progress& progress) {
    // What --rotate does comes before the mirrors, and the body is behind both.
    Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity();
    const PlacementOptions& placed = job.options.placement;
    if (placed.swap_xy) mirror.row(0).swap(mirror.row(1));
    if (placed.flip_x) mirror.row(0) *= -1;
    if (placed.flip_y) mirror.row(1) *= -1;
    const auto turn_of = [&](const std::string& text) -> Eigen::Matrix3d {
        return mirror * (text.empty() ? Eigen::Matrix3d::Identity() : parse_rotation(text)) * mirror.transpose();
    };
    const std::vector<Piece> pieces = pieces_of(body);
    const double area_mm2 = coloured_area_mm2(*body.surface);
    std::vector<Orientation> found(up_turns.size() * turns_about_z.size());
    parallel_for(
        0, up_turns.size(), 1,
        [&](std::size_t up) {
            const SolidMesh turned = turned_mesh(*body.solid, turn_of(up_turns[up]));
            Orientation seen;
            look_from_below(pieces, area_mm2, turned, turn_of(up_turns[up]), seen);
            for (std::size_t about = 0; about < turns_about_z.size(); ++about) {
                const std::string turn = joined(up_turns[up], turns_about_z[about]);
                Orientation& orientation = found[up * turns_about_z.size() + about];
                orientation = seen;
                orientation.rotate = joined(placed.rotation_text, turn);
                measure(job, (turn_of(turn) * body.placement.extent_mm).cwiseAbs(), orientation);
            }
        },
        &progress);
    std::stable_sort(found.begin() + 1, found.end(), [](const Orientation& a, const Orientation& b) {
        return std::pair(a.coloured_down_mm2, a.layers) < std::pair(b.coloured_down_mm2, b.layers);
    });
    return found;
}

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/emboss.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace voxtone::slicer {

namespace {

constexpr std::uint8_t half_ink = 128;

struct DepthRange {
    double least = 0, most = 0;
    bool any = false;
};

DepthRange depths_of(const io::DepthMap& map) {
    DepthRange range;
    for (const float depth : map.depth_mm) {
        if (!std::isfinite(depth)) continue;
        range.least = range.any ? std::min(range.least, double(depth)) : double(depth);
        range.most = range.any ? std::max(range.most, double(depth)) : double(depth);
        range.any = true;
    }
    return range;
}

/// Between the four points around a place; infinite where one of them is.
double depth_at(const io::DepthMap& map, double along, double up) {
    const double x = along * (map.columns - 1), y = up * (map.rows - 1);
    const auto i = std::min(std::uint32_t(x), map.columns - 2), j = std::min(std::uint32_t(y), map.rows - 2);
    const double u = x - i, v = y - j;
    const auto at = [&](std::uint32_t a, std::uint32_t b) {
        return double(map.depth_mm[std::size_t{b} * map.columns + a]);
    };
    return (1 - v) * ((1 - u) * at(i, j) + u * at(i + 1, j)) + v * ((1 - u) * at(i, j + 1) + u * at(i + 1, j + 1));
}

/// All that the mark's rectangle sweeps from so far above the surface to so far below it.
Eigen::AlignedBox3d swept_box(const EmbossedMark& mark, double above_mm, double below_mm) {
    const DepthRange depths = depths_of(mark.surface);
    Eigen::AlignedBox3d box;
    if (!depths.any) return box;
    for (const double x : {0.0, mark.frame.width_mm})
        for (const double y : {0.0, mark.frame.height_mm}) {
            box.extend(mark.frame.at(x, y, depths.least - above_mm));
            box.extend(mark.frame.at(x, y, depths.most + below_mm));
        }
    return box;
}

/// How deep below the surface, straight along the mark's direction; nothing beside its ink.
std::optional<double> depth_below_ink(const EmbossedMark& mark, const Eigen::Vector3d& place) {
    const Eigen::Vector3d offset = place - mark.frame.corner_mm;
    const double along = mark.frame.axes.right.dot(offset) / mark.frame.width_mm,
                 up = mark.frame.axes.up.dot(offset) / mark.frame.height_mm;
    if (!(along >= 0 && along < 1 && up > 0 && up <= 1)) return std::nullopt;
    if (mark.ink.at(int(along * mark.ink.width_px), int((1 - up) * mark.ink.height_px)) < half_ink) return std::nullopt;
    const double depth = -mark.frame.axes.out.dot(offset) - depth_at(mark.surface, along, up);
    return std::isfinite(depth) ? std::optional(depth) : std::nullopt;
}

/// What becomes of a voxel.
enum class Fate : std::uint8_t { as_it_is, changed, outside_of_mesh, inside_of_mesh };

Fate fate_of(const std::optional<double>& depth, bool raises, double reach_mm, double shell_mm) {
    if (!depth) return Fate::as_it_is;
    if (raises && *depth < 0) return *depth >= -reach_mm ? Fate::outside_of_mesh : Fate::as_it_is;
    if (!raises && *depth < reach_mm) return *depth >= 0 ? Fate::changed : Fate::as_it_is;
    return *depth <= shell_mm + reach_mm ? Fate::inside_of_mesh : Fate::as_it_is;
}

void add_runs(const EmbossedMark& mark, const VoxelGrid& grid, double shell_mm, std::vector<ReliefRun>& runs,
              std::vector<DepthRun>& depths) {
    const bool raises = mark.voxels > 0;
    const double reach = std::abs(mark.voxels) * voxel_mm_along(grid.pitch_mm, mark.frame.axes.out);
    const Eigen::AlignedBox3d box = swept_box(mark, raises ? reach : 0, reach + shell_mm);
    if (box.isEmpty()) return;
    std::array<int, 3> low{}, high{};
    for (int axis = 0; axis < 3; ++axis) {
        const auto voxel = [&](double mm) { return (mm - grid.origin_mm[axis]) / grid.pitch_mm[axis]; };
        low[std::size_t(axis)] = std::max(0, int(std::floor(voxel(box.min()[axis]))));
        high[std::size_t(axis)] = std::min(grid.size[std::size_t(axis)], int(std::ceil(voxel(box.max()[axis]))));
    }
    for (int k = low[2]; k < high[2]; ++k)
        for (int j = low[1]; j < high[1]; ++j) {
            Fate before = Fate::as_it_is;
            for (int i = low[0]; i < high[0]; ++i) {
                const Fate fate = fate_of(depth_below_ink(mark, grid.centre(i, j, k)), raises, reach, shell_mm);
                const bool begins = fate != before;
                before = fate;
                if (fate == Fate::outside_of_mesh || fate == Fate::changed) {
                    if (begins) runs.push_back({k, j, i, i, raises});
                    runs.back().end = i + 1;
                }
                if (fate == Fate::outside_of_mesh || fate == Fate::inside_of_mesh) {
                    if (begins)
                        depths.push_back(
                            {k, j, i, i, fate == Fate::outside_of_mesh ? -1.0f : 1.0f, float(raises ? reach : -reach)});
                    depths.back().end = i + 1;
                }
            }
        }
}

}  // namespace

double voxel_mm_along(const Eigen::Vector3d& pitch_mm, const Eigen::Vector3d& direction) {
    return direction.cwiseProduct(pitch_mm).norm();
}

Eigen::AlignedBox3d box_of_raised(std::span<const EmbossedMark> marks, const Eigen::Vector3d& pitch_mm) {
    Eigen::AlignedBox3d box;
    for (const EmbossedMark& mark : marks)
        if (mark.voxels > 0)
            box.extend(swept_box(mark, mark.voxels * voxel_mm_along(pitch_mm, mark.frame.axes.out), 0));
    return box;
}

Relief relief_of(std::span<const EmbossedMark> marks, const VoxelGrid& grid, double shell_mm) {
    std::vector<ReliefRun> runs;
    std::vector<DepthRun> depths;
    for (const EmbossedMark& mark : marks) add_runs(mark, grid, shell_mm, runs, depths);
    return Relief(runs, depths);
}

}  // namespace voxtone::slicer

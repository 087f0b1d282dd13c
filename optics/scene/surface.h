// SPDX-License-Identifier: GPL-3.0-or-later
//
// The surface of a voxel body: exposed faces, grouped into viewing cells, and the smooth surface they stand for.
//
// The outward normal at a face is minus the gradient of the occupancy, smoothed by a Gaussian of 0.12 mm cut at 0.3 mm:
// exact for planes parallel to the axes and, by the symmetry of the kernel, on average for all others. A face that
// belongs to a flat terrace at least 0.5 mm wide along both of its edges keeps its own direction, so that the edges of
// a box stay sharp. A face with direction e of a surface with normal n stands for 1 / (|nx| + |ny| + |nz|) of its area.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/progress.h"
#include "optics/media/effective_medium.h"
#include "optics/scene/scene.h"

namespace voxtone::optics {

/// Which way a voxel's face looks; `axis = direction / 2`, odd ones look along the positive axis.
enum class Facing : std::uint8_t { minus_x, plus_x, minus_y, plus_y, minus_z, plus_z };

/// The neighbours of a voxel, by Facing.
inline constexpr std::array<std::array<int, 3>, 6> step_of{
    {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

/// A voxel's face between resin and air.
struct SurfaceFace {
    std::array<std::uint16_t, 3> voxel{};  ///< the solid side
    Facing facing{};
    bool slants =
        false;  ///< the smooth surface there has the slope of the face's cell and not the face's own direction
};

/// A piece of surface that is seen as one: the exposed faces of the voxels of one cell of the viewing grid.
struct SurfaceCell {
    std::array<std::int32_t, 3> cell{};  ///< place in the viewing grid: voxel / cell size
    std::uint32_t first_face = 0, faces = 0;
    std::array<float, 3> centre_mm{};  ///< of the faces
    std::array<float, 3> normal{};     ///< outward, unit length: of the smooth surface that the staircase stands for
    float area_mm2 = 0;                ///< of that surface
};

/// Surface cells, in order of z, y, x of the viewing grid, and their faces.
struct Surface {
    std::array<int, 3> cell_voxels{};
    std::vector<SurfaceCell> cells;
    std::vector<SurfaceFace> faces;
    /// Per cell: the smooth surface's normal at those of its faces that slant; empty where none of the faces does.
    std::vector<std::array<float, 3>> slope;
    /// Of the smooth surface, at a face of a cell.
    [[nodiscard]] std::array<float, 3> normal_at(std::size_t cell, std::size_t face) const;
};

enum class SurfacePart {
    all,  ///< every face that sees light
    top,  ///< the uppermost face of each column, looking up, as a picture on a slab is looked at; normals are +z
};

/// Voxels per viewing cell that come nearest to cubes of `cell_mm`; J750 and 0.085 mm: 2 x 1 x 3.
[[nodiscard]] std::array<int, 3> cell_voxels(const std::array<double, 3>& pitch_mm, double cell_mm);

/// A box of voxels: the first and one past the last along each axis.
struct VoxelBox {
    std::array<int, 3> begin{}, end{};
    [[nodiscard]] bool holds(const std::array<int, 3>& voxel) const {
        for (std::size_t a = 0; a < 3; ++a)
            if (voxel[a] < begin[a] || voxel[a] >= end[a]) return false;
        return true;
    }
};

/// The surface of a scene's volume. Faces on a sheet and on mirrored sides do not count. Throws Cancelled, and
/// ResourceError for a volume of more than 65,536 voxels along an axis.
[[nodiscard]] Surface find_surface(const Scene& scene, const std::array<int, 3>& cell_voxels, SurfacePart part,
                                   const Progress* progress = nullptr);
/// All of it inside a box, and perhaps some around.
[[nodiscard]] Surface find_surface_near(const Scene& scene, const std::array<int, 3>& cell_voxels, const VoxelBox& box,
                                        const Progress* progress = nullptr);

/// Which way light falls on the voxels under a surface: from above where nine tenths of its area look along z, whether
/// up or down.
[[nodiscard]] SeenFrom seen_from(const Surface& surface);

/// The cells of a surface that are listed, with their faces.
[[nodiscard]] Surface part_of(const Surface& surface, std::span<const std::uint32_t> cells);

}  // namespace voxtone::optics

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which faces of the staircase of a viewing grid stand for the cells of a surface.
//
// Each face of a voxel is seen through the nearest face to the light that looks the same way, or where there is none
// near through the nearest one that looks towards the cell's normal. On a slanting surface the faces around share, by a
// Gaussian of 0.05 mm, so that a picture does not show the steps.
#pragma once

#include <cstdint>
#include <vector>

#include "optics/grid/viewing_grid.h"
#include "optics/scene/surface.h"

namespace voxtone::optics {

/// Of a surface cell that has no solid cell near.
inline constexpr std::uint32_t no_cell = 0xffffffffu;

/// For each cell of a surface: entries first[i] .. first[i + 1] - 1; `share` is the area of voxel faces seen there /
/// the area of the face. A cell without entries has no face of the staircase near.
struct ViewingFaces {
    std::vector<std::uint32_t> first, face;
    std::vector<float> share;
    std::vector<std::uint32_t> cell;  ///< the solid cell nearest to each surface cell; or `no_cell`
};
/// Throws Cancelled.
[[nodiscard]] ViewingFaces find_viewing_faces(const ViewingGrid& grid, const Surface& surface,
                                              const Progress* progress = nullptr);

/// Given blocks and faces: the law of each (transport_directions.h) from the mean normal of the voxel faces that are
/// seen through it, or of faces near by; which blocks slant, and which way the surface near each lies. Throws
/// Cancelled.
void find_face_laws(ViewingGrid& grid, const Scene& scene, const Progress* progress);

/// Given what the cells hold: where resins have indices of their own, the index of each face is the mean, by volume, of
/// what lies at it (decisions/028).
void choose_face_indices(ViewingGrid& grid);

}  // namespace voxtone::optics

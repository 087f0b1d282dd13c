// SPDX-License-Identifier: GPL-3.0-or-later
//
// The solid on the printer's grid: voxel (i, j, k) belongs to the body when the winding number of the surface at the
// voxel's centre is not zero, so nested and overlapping shells are a union.
//
// How: vertices are rounded to a fixed-point lattice of 2^-16 voxel (coarser for grids above 16384 voxels along an
// axis, so that all products fit 64 bits); from there on everything is exact integer arithmetic. Each triangle is
// rasterised on the y-z plane at the row and layer centres, each crossing is reduced to the first voxel whose centre
// lies at or behind it, and the crossings of a row are summed from -x on. Centres on the surface count as if moved by
// (e, e^2, e^3), e an infinitesimal: the same rule for every triangle, so every closed chain is rasterised without
// cracks.
//
// Range: mesh and grid together below 2^22 voxels along each axis. Error: that of the rounding, 2^-17 voxel per
// coordinate. Threads: const members may be called from any thread. slab() of a layer does not depend on the other
// layers asked for.
#pragma once

#include "slicer/mesh/solid_mesh.h"
#include "slicer/printer/voxel_grid.h"
#include "slicer/solid/fixed_mesh.h"
#include "slicer/solid/relief.h"
#include "slicer/solid/span_slab.h"

namespace voxtone::slicer {

class Solid {
public:
    /// `mesh` must be closed as a chain (see mesh_diagnosis.h); it is not kept. `relief`: on this grid.
    Solid(const SolidMesh& mesh, const VoxelGrid& grid, Relief relief = {});

    [[nodiscard]] const VoxelGrid& grid() const { return grid_; }
    /// The layers [k_begin, k_end), 0 <= k_begin <= k_end <= grid().size[2].
    void slab(int k_begin, int k_end, SpanSlab& out) const;
    [[nodiscard]] SpanSlab slab(int k_begin, int k_end) const {
        SpanSlab out;
        slab(k_begin, k_end, out);
        return out;
    }
    /// Volume enclosed by the rounded surface, where shells that overlap count as often as they wind (mm^3).
    [[nodiscard]] double winding_volume_mm3() const;

    /// For the search for thin features.
    [[nodiscard]] const FixedMesh& fixed_mesh() const { return mesh_; }

private:
    VoxelGrid grid_;
    FixedMesh mesh_;
    Relief relief_;
};

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether a body is thick enough for the laminates that are wrapped around it.
//
// From 20,000 points spread evenly over the surface one goes inwards along the normal, as deep as the laminate there
// reaches. The depth that is there ends where another part of the surface comes nearer (by more than a voxel): behind
// thin walls and beside sharp edges, where the layers of both sides meet.
#pragma once

#include <optional>

#include "base/progress.h"
#include "scattering/print/wrapped_layers.h"
#include "slicer/printer/voxel_grid.h"
#include "slicer/surface/visible_surface.h"

namespace voxtone::scattering {

struct LaminateFit {
    double thin_share = 0;    ///< of the surface whose laminate does not fit, in [0, 1]
    double missing_mean = 0;  ///< there: mean share of the laminate's depth that is not there
};

/// `slab_mm`: thickness of a picture's slab; nothing: a body.
[[nodiscard]] LaminateFit laminate_fit(const slicer::SurfaceIndex& coloured, const slicer::VoxelGrid& grid,
                                       std::optional<double> slab_mm, const WrappedLayers& wrapped,
                                       const Progress& progress);

}  // namespace voxtone::scattering

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Wrapped layers as closed surfaces, one mesh for each resin, for printers that are fed with meshes.
// Based on: M. Hasan, M. Fuchs, W. Matusik, H. Pfister, S. Rusinkiewicz, "Physical reproduction of materials with
// specified subsurface scattering", SIGGRAPH 2010, Sec. 7.2; the surfaces are OpenVDB's (dual contouring) instead of
// marching cubes.
//
// On a grid of cubic cells, with d the distance to the surface (negative outside) and [a, b) the depths that a resin
// fills at the nearest surface point, neighbouring layers of one resin joined, the resin is where
//
//   f = min over its intervals of max(a - d, d - b)  < 0,   cut off at the body's own surface
//
// Where a layer has thickness zero f is not negative: nothing is left of it.
// Error: surfaces are within about a cell; edges and corners are blunted by as much, and layers thinner than a cell
// have holes or vanish. Every mesh is closed: each edge is used as often in the one direction as in the other (by two
// triangles, except where parts touch along an edge).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "io/layers/layer_runs.h"
#include "scattering/print/wrapped_layers.h"
#include "slicer/part/job_body.h"

namespace voxtone::scattering {

struct LayerSurface {
    io::Material material = io::background;
    std::vector<Eigen::Vector3f> positions_mm;
    std::vector<std::array<std::uint32_t, 3>> triangles;  ///< facing outwards
    double volume_mm3 = 0;
};

/// Of each material that is anywhere, in ascending order. Throws InputError where the cells are so small that there are
/// more than 2^29 of them.
[[nodiscard]] std::vector<LayerSurface> layer_surfaces(const slicer::JobBody& body, const WrappedLayers& wrapped,
                                                       double cell_mm, Progress& progress);

}  // namespace voxtone::scattering

// SPDX-License-Identifier: GPL-3.0-or-later
//
// A surface as the report's viewer carries it: a body as a mesh with one colour a vertex, a picture as pixels, both no
// larger than the page has room for.
//
// What has more places than that is taken together: vertices by cubes (clustered_mesh.h), pixels by squares of whole
// ones. A place shows the mean of its parts in linear light, and the mean of their differences.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "io/models/coloured_mesh.h"
#include "io/report/report.h"
#include "optics/media/resin_volume.h"
#include "optics/scene/surface.h"
#include "slicer/surface/coloured_surface.h"

namespace voxtone::slicer {

/// One colour for each vertex or cell, linear sRGB.
struct SurfaceLook {
    std::string name, caption;
    std::vector<Eigen::Vector3f> rgb;
};

/// What is shown of it: the target first.
struct SurfaceLooks {
    std::vector<SurfaceLook> looks;
    std::vector<double> seen, single;  ///< CIEDE2000; empty where they are not known
};

/// Of the room that a page has left: the surface gets rather more than half, the voxels the rest.
[[nodiscard]] std::size_t surface_bytes_left(const io::Report& report);
[[nodiscard]] std::size_t voxel_bytes_left(const io::Report& report);

/// `mesh`: its positions in mm from the corner of the print; its own colours are not looked at. `grain_mm`: how far
/// apart its vertices are.
[[nodiscard]] io::ViewerSurface viewer_body(const io::ColouredMesh& mesh, const SurfaceLooks& looks, double grain_mm,
                                            std::size_t bytes);

/// The top of a slab, one look a cell of `surface`.
[[nodiscard]] io::ViewerSurface viewer_picture(const optics::ResinVolume& volume, const optics::Surface& surface,
                                               const SurfaceLooks& looks, std::size_t bytes);

/// A surface whose colours are known at its points, without a prediction.
struct PaintedSurface {
    std::string name, caption;
    ColouredSurface surface;
};

/// Surfaces of the same triangles, mm on the tray; `corner_mm`: of the print. The first one's colours say where there
/// are vertices; a slab is drawn from above. `differences`: whether the second differs from the first in CIEDE2000.
[[nodiscard]] io::ViewerSurface viewer_painted(std::span<const PaintedSurface> surfaces,
                                               const Eigen::Vector3d& corner_mm, bool from_above, bool differences,
                                               std::size_t bytes, const Progress* progress);

}  // namespace voxtone::slicer

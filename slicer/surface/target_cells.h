// SPDX-License-Identifier: GPL-3.0-or-later
//
// What was asked for, cell by cell of the viewing grid, and how far a prediction is from it.
//
// The target of a cell is the mean, in linear light, of the target colour over its faces: each sample on a face takes
// the colour of the nearest point of the coloured surface. Differences are CIEDE2000 of linear sRGB under D65, the
// prediction relative to the white resin. Figures over the surface weigh each cell with its area, as a viewer does.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "io/models/mesh.h"
#include "optics/scene/appearance_model.h"
#include "optics/scene/area_summary.h"
#include "slicer/surface/visible_surface.h"

namespace voxtone::slicer {

/// Linear sRGB per cell. `corner_mm`: place of the volume in the frame of the surface. `surface`: the coloured surface
/// of the mesh.
[[nodiscard]] std::vector<Eigen::Vector3f> target_of_cells(const optics::Surface& cells,
                                                           const std::array<double, 3>& pitch_mm,
                                                           const Eigen::Vector3d& corner_mm,
                                                           const SurfaceIndex& surface, const io::TexturedMesh& mesh,
                                                           const Progress* progress);

/// Of a point of the mesh: corner0 + u (corner1 - corner0) + v (corner2 - corner0) of a triangle.
using ValueOfPoint = std::function<Eigen::Vector3f(std::uint32_t triangle, float u, float v)>;

/// As far apart as its points are taken in a cell.
[[nodiscard]] double sample_spacing_mm(const optics::Surface& cells, const std::array<double, 3>& pitch_mm);

/// The same mean of any three values; called from any thread.
[[nodiscard]] std::vector<Eigen::Vector3f> mean_of_cells(const optics::Surface& cells,
                                                         const std::array<double, 3>& pitch_mm,
                                                         const Eigen::Vector3d& corner_mm, const SurfaceIndex& surface,
                                                         const ValueOfPoint& value, const Progress* progress);

/// CIEDE2000 per cell.
[[nodiscard]] std::vector<double> colour_differences(const std::vector<Eigen::Vector3f>& target,
                                                     const std::vector<Eigen::Vector3f>& predicted);

using optics::summarize_by_area;

/// Share of the area with a difference in [edges[i], edges[i + 1]), the last one everything above. Edges rise.
[[nodiscard]] std::vector<double> histogram_by_area(const optics::Surface& cells,
                                                    const std::vector<double>& differences,
                                                    const std::vector<double>& edges);

/// The colour of a difference in a map (linear sRGB): white 0, yellow 2, orange 5, red 10, black 20 and more.
[[nodiscard]] Eigen::Vector3f difference_colour(double de2000);

}  // namespace voxtone::slicer

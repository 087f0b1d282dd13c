// SPDX-License-Identifier: GPL-3.0-or-later
//
// A prediction as files: a picture of a slab seen from above (one pixel per cell), a mesh of a body (one vertex per
// cell), orthographic pictures of that mesh.
//
// Pictures have +x to the right and +y up: the top row is the one with the largest y.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "base/progress.h"
#include "io/models/coloured_mesh.h"
#include "io/models/ply_writer.h"
#include "io/pictures/exr_writer.h"
#include "io/pictures/picture_writer.h"
#include "slicer/look/preview.h"
#include "slicer/look/surface_prediction.h"

namespace voxtone::slicer {

/// Cells of the viewing grid along x and y of a volume.
[[nodiscard]] std::array<int, 2> picture_cells(const optics::ResinVolume& volume,
                                               const std::array<int, 3>& cell_voxels);

/// Pixels per mm along x and y, one pixel a cell.
[[nodiscard]] std::array<double, 2> picture_px_per_mm(const optics::ResinVolume& volume,
                                                      const std::array<int, 3>& cell_voxels);

/// Colours of a surface of SurfacePart::top; a pixel without a cell is transparent.
[[nodiscard]] io::LinearPicture top_picture(const optics::ResinVolume& volume, const SurfacePrediction& prediction);

/// Its numbers. RGB sets: R, G, B, A (1 where there is a cell) and, where the model gives them, standard errors
/// error.R, error.G, error.B. Spectral sets: R, G, B are the colour in linear sRGB, followed by A and "450nm", ...,
/// "error.450nm", ...
[[nodiscard]] io::NumberPicture top_numbers(const optics::ResinVolume& volume, const optics::Channels& channels,
                                            const SurfacePrediction& prediction);

/// The whole surface as a mesh, `corner_mm` the place of the volume; vertex i is cell i.
[[nodiscard]] io::ColouredMesh body_mesh(const optics::ResinVolume& volume, const std::array<double, 3>& corner_mm,
                                         const SurfacePrediction& prediction);
/// The same where its triangles are known.
[[nodiscard]] io::ColouredMesh body_mesh(std::vector<std::array<std::uint32_t, 3>> triangles,
                                         const std::array<double, 3>& corner_mm, const SurfacePrediction& prediction);

/// Per vertex: appearance_r, ... and error_r, ... (RGB sets) or appearance_450nm, ...
[[nodiscard]] io::VertexNumbers body_numbers(const optics::Channels& channels, const SurfacePrediction& prediction);

/// The mesh with its colours in between, for `render_views`; keeps references to both.
[[nodiscard]] ColouredSurface mesh_surface(const io::ColouredMesh& mesh, std::vector<Eigen::Vector3d>& positions_mm);
/// The same in other colours of its vertices.
[[nodiscard]] ColouredSurface recoloured(ColouredSurface surface, std::span<const Eigen::Vector3f> rgb);

constexpr int views_gap_px = 8;
/// Pictures side by side, four in a row, so far apart.
[[nodiscard]] io::LinearPicture side_by_side(std::span<const Preview> views);

}  // namespace voxtone::slicer

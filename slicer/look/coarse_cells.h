// SPDX-License-Identifier: GPL-3.0-or-later
//
// Predictions in cells larger than the eye's, for a quick look.
//
// The predictor (optics/transport) cuts the blocks of 4 x 4 x 4 cells that light enters into voxels: larger cells would
// make it slower, because its blocks grow with them and hold more voxels. So larger cells are made of the eye's: the
// print is predicted on cells of the eye's size throughout, as the appearance loop does it (docs/predict.md,
// "Sequences"), in a third of the time and up to 2 CIEDE2000 off in fine patterns, and averaged over the larger ones.
#pragma once

#include <array>
#include <optional>

#include "slicer/look/surface_prediction.h"

namespace voxtone::slicer {

/// What a person resolves at 300 mm; `--cell` as it is by default.
inline constexpr double eye_cell_mm = 0.085;

/// Voxels of a cell of the eye, and of a larger one that is made of whole ones.
struct CoarseCells {
    std::array<int, 3> eye{}, coarse{};
};
/// Nothing where a cell of `cell_mm` is not at least two of the eye's wide along some axis.
[[nodiscard]] std::optional<CoarseCells> coarse_cells(const std::array<double, 3>& pitch_mm, double cell_mm);
/// Voxels of a cell of about `cell_mm`, the same for every model: the coarse ones where there are such.
[[nodiscard]] std::array<int, 3> seen_cell_voxels(const std::array<double, 3>& pitch_mm, double cell_mm);

/// The mean of `fine` over each cell of `surface`, by area. The cells of `surface` are whole ones of those of `fine`,
/// and both are the same part of the same body. Standard errors are left out.
[[nodiscard]] SurfacePrediction averaged(const SurfacePrediction& fine, optics::Surface surface,
                                         optics::SurfacePart part);

}  // namespace voxtone::slicer

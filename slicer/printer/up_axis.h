// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which way up a model was drawn, guessed from what it would stand on. OBJ files do not say; most modelling programs
// write them with y up, printers take z for up.
#pragma once

#include <span>

#include <Eigen/Core>

namespace voxtone::slicer {

/// True where the model stands well on its lowest y and not on its lowest z: the outline of its lowest fiftieth covers
/// at least a fifth of its bounding rectangle there, and two and a half times as much as that of the other. Bodies
/// that stand on both (a cube) or on neither (a ball) give false.
[[nodiscard]] bool looks_y_up(std::span<const Eigen::Vector3d> positions);

/// The same for files whose y axis points up by their format, and which were turned, (x, y, z) to (x, -z, y): true
/// where the model stands on its lowest z as it was written, and not on its lowest y.
[[nodiscard]] bool looks_z_up_before(std::span<const Eigen::Vector3d> turned);

}  // namespace voxtone::slicer

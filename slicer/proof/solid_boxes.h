// SPDX-License-Identifier: GPL-3.0-or-later
//
// Slabs side by side: stacks that no model is known of, but whose surface is that of boxes.
#pragma once

#include <vector>

#include "optics/media/resin_volume.h"
#include "slicer/proof/proof_camera.h"

namespace voxtone::slicer {

/// Boxes along x, each as deep as the volume, that hold all of its resin and nothing else; mm from the volume's corner.
/// None where its body is not made of such.
[[nodiscard]] std::vector<Box> solid_boxes(const optics::ResinVolume& volume);

}  // namespace voxtone::slicer

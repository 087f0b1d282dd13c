// SPDX-License-Identifier: GPL-3.0-or-later
//
// The mixture that light sees at each place of a surface: shares of the resins around it, weighed by a Gaussian of
//
//   sigma = 0.12 mm
//
// about the place, solid voxels alone. That is about how far light goes in opaque resins before it turns back (their
// reduced free paths are 0.05 to 0.3 mm), so mixtures run into each other where colours do, and a halftone of voxels
// becomes the mixture that it stands for. What it cannot see: that light goes farther in white and in red.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "base/progress.h"
#include "optics/media/resin_volume.h"
#include "optics/scene/surface.h"

namespace voxtone::optics {

/// [cell * resins + resin]; shares of a cell sum to 1. The same bits for any number of threads.
[[nodiscard]] std::vector<float> surface_mixtures(const ResinVolume& volume, const Surface& surface, std::size_t resins,
                                                  const Progress* progress = nullptr);

/// The same about one place of the volume, mm from its corner; all 0 where nothing solid is near.
void mixture_at(const ResinVolume& volume, const std::array<float, 3>& place_mm, std::span<float> shares);

}  // namespace voxtone::optics

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The gradient of the loop's misfit by its unknowns: what a model says of every voxel, summed over the voxels that
// share a mixture. Summed in whole numbers of 2^-32, so that the order does not matter: the same bits for any number of
// threads.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "base/progress.h"
#include "optics/scene/appearance_model.h"
#include "slicer/colour/print_parts.h"
#include "slicer/layers/skin_source.h"

namespace voxtone::slicer {

/// [(cell * layers + layer) * resins + resin]; `cells` of them. `visit_all` hands the gradient over, box by box; empty
/// where it says that there is none. `kept`: what the map says of each voxel; null: it is asked. Memory: 8 bytes a
/// value while it works.
[[nodiscard]] std::vector<float> skin_gradient(
    const PrintParts& parts, const SkinMap& map, const SkinVoxels* kept, std::size_t cells, std::size_t resins,
    const std::function<bool(const optics::AppearanceSequence::GradientVisitor&)>& visit_all, const Progress& progress);

}  // namespace voxtone::slicer

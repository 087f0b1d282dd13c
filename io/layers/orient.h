// SPDX-License-Identifier: GPL-3.0-or-later
//
// Mirrored and transposed layers, for printers that print a bitmap the other way round.
#pragma once

#include "io/layers/layer_runs.h"
#include "io/layers/manifest.h"

namespace voxtone::io {

/// The layer as `orientation` says: first rows and columns swapped, then columns mirrored, then rows.
[[nodiscard]] LayerRuns oriented(const LayerRuns& layer, const Orientation& orientation);
/// The layer as it was before `oriented`: in the model's frame.
[[nodiscard]] LayerRuns as_sliced(LayerRuns layer, const Orientation& orientation);

}  // namespace voxtone::io

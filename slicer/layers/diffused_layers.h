// SPDX-License-Identifier: GPL-3.0-or-later
//
// Layers by error diffusion. The shell's mixtures of one layer of blocks are kept block by block (they grow with the
// surface), and laid out in full for one layer at a time, because errors travel across whole layers. Core and air take
// no part: nothing is owed there.
#pragma once

#include "slicer/layers/layer_counts.h"
#include "slicer/layers/layer_sources.h"

namespace voxtone::slicer {

/// The layers [first, last) of a slab of halftone::ErrorDiffusion::slab_layers, from the bottom up; errors start anew
/// at the bottom of the slab. `by_colour`: that of `sources`.
LayerCounts make_diffused_layers(const LayerSources& sources, const MixtureSources& by_colour, int slab, int first,
                                 int last, const LayerSink& sink);

}  // namespace voxtone::slicer

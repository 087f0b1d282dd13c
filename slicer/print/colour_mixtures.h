// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which mixture a colour print will have below a point of its surface, for the count of its resins.
//
// Without the appearance loop that is what its layers are made of: the separation of the colour that is asked for, as
// deep as the shell. The loop starts from colours surface first (halftone/loop/minimal_depth_separation.h), brought
// into the gamut; what it does to single cells afterwards nobody knows before it has run, but their sum changes little.
#pragma once

#include "slicer/part/colour_recipes.h"
#include "slicer/part/opened_job.h"
#include "slicer/print/resin_volumes.h"
#include "slicer/surface/surface_colour.h"

namespace voxtone::slicer {

/// Of the resins of a colour print, by what its layers will ask for.
[[nodiscard]] ResinVolumes colour_volumes(const OpenedJob& job, const JobBody& body, const LayerRange& range,
                                          const ColourRecipes& made_with, const Progress& progress);

}  // namespace voxtone::slicer

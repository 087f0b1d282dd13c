// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the report's viewer gets of a print that shows colours: target, open loop and print on one surface, differences,
// and the ten places that are worst as they are seen.
//
// The worst places: cells in falling order of what is seen, times how far it can be seen (sides_seen.h), each at least
// a twelfth of the body away from those before it, so that one bad patch is named once; none below the verdict's
// "good".
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "io/report/report.h"
#include "slicer/colour/colour_report.h"
#include "slicer/look/viewer_surface.h"

namespace voxtone::slicer {

/// Everything but the voxels. After the pictures of the report are drawn: the page has room for what is left.
void add_viewer(const ColourReport& sources, io::Report& report, const Progress& progress);

/// The surface alone, in about so many bytes of a page.
[[nodiscard]] std::optional<io::ViewerSurface> viewer_surface(const ColourReport& sources, std::size_t bytes,
                                                              const Progress& progress);

/// The worst first, ten at most.
[[nodiscard]] std::vector<io::ViewerPlace> worst_places(const ColourReport& sources, const JobPrediction& prediction);

}  // namespace voxtone::slicer

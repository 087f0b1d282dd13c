// SPDX-License-Identifier: GPL-3.0-or-later
//
// What lies below overhanging body, which support fills, and how the body looks from the front; on a grid of about 1 %
// of its largest extent.
#pragma once

#include <string>
#include <vector>

#include "slicer/mesh/solid_mesh.h"

namespace voxtone::slicer {

/// A view with all that is solid dark.
struct Silhouette {
    int width = 0, height = 0;
    std::vector<char> solid;  ///< rows from the top

    /// In letters, two rows in each, at most so many lines.
    [[nodiscard]] std::vector<std::string> lines(int most_lines) const;
};

struct AirUnder {
    double ml = 0;             ///< below the body, down to the tray
    Silhouette front, turned;  ///< against +y; after a quarter turn about the upright, counter-clockwise
};
/// Of the mesh as it lies. A printer adds to that what the body stands on, and walls beside it.
[[nodiscard]] AirUnder look_under(const SolidMesh& mesh);

}  // namespace voxtone::slicer

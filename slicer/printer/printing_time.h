// SPDX-License-Identifier: GPL-3.0-or-later
//
// How long the printer takes, as far as that can be known: its heads pass over a layer in strips as wide as themselves,
// so that what counts is passes times layers. A print that is as wide as one strip takes one pass a layer however long
// it is along the heads' way; the same laid across takes many.
//
// Not counted: the length of a pass, layers that a strip has nothing in, warming, cleaning.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "slicer/printer/voxel_grid.h"

namespace voxtone::slicer {

/// Of a printer whose heads run along one axis of the tray. `along`, of the frame in which it is asked for: 0 x, 1 y.
struct HeadPasses {
    int along = 0;
    double width_mm = 0;            ///< of the strip that one pass prints; 0: not known
    std::optional<double> seconds;  ///< of one pass; nothing: the maker does not say
    std::string source;             ///< of these figures

    [[nodiscard]] bool known() const { return width_mm > 0; }
    [[nodiscard]] int across() const { return 1 - along; }
    /// Over a layer of a print of this extent; 0: not known. What is as wide as the strip takes one.
    [[nodiscard]] int of_layer(const Eigen::Vector3d& extent_mm) const;
};

struct PrintingTime {
    int passes_of_layer = 0;        ///< of the print that takes most; 0: not known
    std::uint64_t passes = 0;       ///< of all layers
    std::optional<double> seconds;  ///< of the printer
    std::string source;

    /// Adds a print that is made after the others.
    void add(const HeadPasses& heads, const Eigen::Vector3d& extent_mm, std::uint64_t layers);
};

/// "1112 passes of the heads, 1 a layer; ..." without the source; empty: not known.
[[nodiscard]] std::string printing_text(const PrintingTime& time);

/// Of a grid's box.
[[nodiscard]] inline Eigen::Vector3d length_of(const VoxelGrid& grid) {
    return grid.pitch_mm.cwiseProduct(Eigen::Vector3d(grid.size[0], grid.size[1], grid.size[2]));
}

}  // namespace voxtone::slicer

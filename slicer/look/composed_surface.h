// SPDX-License-Identifier: GPL-3.0-or-later
//
// Surfaces of several bodies as one, each at its places in their print: what the report of a tray turns.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "io/report/viewer.h"
#include "slicer/surface/coloured_surface.h"

namespace voxtone::slicer {

struct PlacedSurface {
    const io::ViewerSurface* surface = nullptr;  ///< mm from the corner of its own body
    std::vector<Eigen::Vector3d> at_mm;          ///< that corner, from the corner of the print
};

/// The looks that all have, in the order of the first. Differences where all know them. A picture becomes the slab it
/// is printed as, with grey sides. Contract: there is a surface that stands somewhere.
[[nodiscard]] io::ViewerSurface compose_surfaces(std::span<const PlacedSurface> surfaces);

/// A body's surface in one of its looks, to be drawn, of what is clear a lattice. Keeps a reference; `positions_mm` and
/// `triangles` are filled.
[[nodiscard]] ColouredSurface coloured_surface(const io::ViewerSurface& body, const io::ViewerLook& look,
                                               std::vector<Eigen::Vector3d>& positions_mm,
                                               std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace voxtone::slicer

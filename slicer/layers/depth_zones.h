// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which voxels below the surface carry colour where clear resin lies over the colours (--coat), or over and under them
// (--enclose): by depth below the surface, clear, then colour, then core, then clear again.
#pragma once

#include <limits>

#include "optics/layered/shell_appearance.h"

namespace voxtone::slicer {

struct DepthZones {
    float colour_from_mm = 0;
    float colour_to_mm = std::numeric_limits<float>::infinity();  ///< core below
    float clear_from_mm = std::numeric_limits<float>::infinity();
    int clear = -1, core = -1;  ///< indices of resins; clear is -1 where there is none, and all is colour then

    static constexpr int coloured = -1;
    [[nodiscard]] bool any() const { return clear >= 0; }
    [[nodiscard]] bool is_over(float depth_mm) const { return any() && depth_mm < colour_from_mm; }
    [[nodiscard]] bool is_clear(float depth_mm) const {
        return any() && (depth_mm < colour_from_mm || depth_mm >= clear_from_mm);
    }
    /// The resin that a voxel is all of; `coloured`: a mixture decides.
    [[nodiscard]] int resin_at(float depth_mm) const {
        if (!any()) return coloured;
        if (is_clear(depth_mm)) return clear;
        return depth_mm < colour_to_mm ? coloured : core;
    }
};

[[nodiscard]] inline DepthZones zones_of(const optics::ShellGeometry& geometry) {
    if (geometry.over_mm == 0 && geometry.under_mm == 0) return {};
    DepthZones zones;
    zones.clear = geometry.clear_resin, zones.core = geometry.core_resin;
    zones.colour_from_mm = static_cast<float>(geometry.over_mm);
    zones.colour_to_mm = static_cast<float>(geometry.over_mm + geometry.shell_mm);
    if (geometry.under_mm > 0)
        zones.clear_from_mm = static_cast<float>(geometry.over_mm + geometry.shell_mm + geometry.core_mm);
    return zones;
}

}  // namespace voxtone::slicer

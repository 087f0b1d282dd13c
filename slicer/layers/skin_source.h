// SPDX-License-Identifier: GPL-3.0-or-later
//
// The mixtures of the appearance loop as the layers are made of them: for a shell voxel, that of the surface cell
// nearest to it and of the layer that its depth falls in; core below the skin.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "halftone/loop/skin.h"
#include "halftone/separation/mixture.h"
#include "slicer/layers/cell_index.h"
#include "slicer/layers/depth_zones.h"
#include "slicer/surface/visible_surface.h"

namespace voxtone::slicer {

/// Where a point of a visible triangle lies, from its place (u, v) in the source triangle; mm from the volume's corner.
class SurfacePlaces {
public:
    SurfacePlaces(const VisibleSurface& surface, const Eigen::Vector3d& corner_mm);
    [[nodiscard]] Eigen::Vector3f at(std::uint32_t triangle, float u, float v) const {
        const auto& [origin, along_u, along_v] = frame_[triangle];
        return origin + u * along_u + v * along_v;
    }

private:
    std::vector<std::array<Eigen::Vector3f, 3>> frame_;
};

/// Which unknown of the loop a shell voxel belongs to. Keeps references.
struct SkinMap {
    const SurfacePlaces& places;
    const CellIndex& cells;
    const halftone::SkinLayers& layers;
    DepthZones zones = {};
    std::span<const char> apart = {};  ///< by visible triangle: the loop does not look there; empty: everywhere
    static constexpr std::size_t core = ~std::size_t{0}, clear = core - 1;
    [[nodiscard]] bool is_apart(std::uint32_t triangle) const { return !apart.empty() && apart[triangle] != 0; }
    /// cell * layers + layer; `core` below the skin and where the loop does not look; `clear` in clear resin over or
    /// under it.
    [[nodiscard]] std::size_t at(std::uint32_t triangle, float u, float v, float distance_mm) const {
        if (zones.is_clear(distance_mm)) return clear;
        if (is_apart(triangle)) return core;
        const std::size_t layer = layers.layer_of(distance_mm - zones.colour_from_mm);
        return layer == layers.size() ? core : std::size_t{cells.at(places.at(triangle, u, v))} * layers.size() + layer;
    }
};

class SkinSource {
public:
    /// `core`: index of the core resin, which stands for what is clear, too: of that BlockMixtures takes no mixture.
    SkinSource(const SkinMap& map, const halftone::SkinMixtures& mixtures, int core);
    /// The same with the mixtures as `halftone::cumulative_mixtures` makes them.
    SkinSource(const SkinMap& map, std::vector<halftone::CumulativeMixture> mixtures, std::size_t resins, int core);
    /// Whether the loop looks at this triangle: the mixtures of others are the separation's.
    [[nodiscard]] bool knows(std::uint32_t triangle) const { return !map_.is_apart(triangle); }
    [[nodiscard]] const halftone::CumulativeMixture& mixture(std::uint32_t triangle, float u, float v,
                                                             float distance_mm) const {
        const std::size_t at = map_.at(triangle, u, v, distance_mm);
        return at >= SkinMap::clear ? core_ : mixture_[at];
    }

private:
    SkinMap map_;
    std::vector<halftone::CumulativeMixture> mixture_;
    halftone::CumulativeMixture core_;
};

}  // namespace voxtone::slicer

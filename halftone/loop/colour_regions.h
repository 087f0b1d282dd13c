// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a person sees as one thing: connected pieces of one flat colour in the target. Photographs have hardly any.
//
// Cells that touch and look the same way belong together while each is within 0.008 of its neighbour and 0.012 of the
// first in Oklab; a piece is one thing where at least half of what lies three cells around it is 0.05 or farther from
// it: the smooth grounds of photographs are not. Pieces from 1 mm2 on are solids, but for the long blurred edges of
// others: nowhere wider than two cells, half of them or more a mixture of what lies on either side. Smaller ones of one
// colour together are strokes, wherever they lie; those nowhere wider than two cells only in a colour that something
// wider has, for they may be blurred edges. Of less than 0.2 mm2 in all nothing is made. What is paper (paper.h) is one
// region of each colour, in however many pieces. The interior of a region are the cells that lie 0.6 mm from its border
// or farther, or all where those are less than a fifth.
//
// A region is judged as a region, by its interior: the CIEDE2000 between the mean colours of target and print, and its
// unevenness, the root mean square distance of the differences from their mean, in Lab. Both are of what the eye's
// narrowest Gaussian leaves (EyeFilter::smoothed): the wide ones of colour carry the neighbours' into a region.
// What it cannot see: gradients, textures; that a person knows a letter from a line.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "base/parallel.h"
#include "optics/scene/appearance_model.h"

namespace voxtone::halftone {

enum class RegionKind : std::uint8_t { paper, solid, strokes };

struct ColourRegion {
    RegionKind kind = RegionKind::solid;
    Eigen::Vector3f target = Eigen::Vector3f::Zero();  ///< mean, linear sRGB
    double area_mm2 = 0;
    std::vector<std::uint32_t> cells, interior;  ///< ascending
};

/// By falling area. `target`: linear sRGB per cell of the surface.
[[nodiscard]] std::vector<ColourRegion> colour_regions(const optics::Surface& surface,
                                                       std::span<const Eigen::Vector3f> target);

/// Which cells of a surface touch. Keeps a reference.
class CellNeighbours {
public:
    explicit CellNeighbours(const optics::Surface& surface);
    ~CellNeighbours();
    CellNeighbours(const CellNeighbours&) = delete;
    CellNeighbours& operator=(const CellNeighbours&) = delete;

    [[nodiscard]] const optics::Surface& surface() const { return surface_; }
    /// Cells within so many steps of a region that are not of it: what it is seen against. Ascending.
    [[nodiscard]] std::vector<std::uint32_t> around(const ColourRegion& region, int steps) const;
    /// All that touch a cell, itself too; ascending.
    void visit_around(std::size_t cell, BorrowedFunction<std::size_t> visit) const;

    class Rows;

private:
    const optics::Surface& surface_;
    std::unique_ptr<const Rows> rows_;
};

/// Mean chroma of print less target, CIELAB, of the cells within 0.6 mm of a region's edge, on both sides: a rim of
/// another hue is seen more than a wide neutral transition. `near_target`, `near`: as for look_at.
[[nodiscard]] double rim_chroma(const ColourRegion& region, const CellNeighbours& cells,
                                std::span<const Eigen::Vector3f> near_target, std::span<const Eigen::Vector3f> near);

struct RegionLook {
    Eigen::Vector3d lab = Eigen::Vector3d::Zero();    ///< of the print's mean
    Eigen::Vector3d asked = Eigen::Vector3d::Zero();  ///< of the target's
    double difference = 0;                            ///< CIEDE2000 of the means
    double unevenness = 0;
};

/// By how much a region is seen to be worse than it was: in its mean, and twice that in its evenness, for mottle is
/// seen at a fraction of what a mean is. 0: in neither.
[[nodiscard]] double worse_by(const RegionLook& now, const RegionLook& before);

/// `near_target`, `near`: what the narrowest Gaussian leaves of target and print, linear sRGB.
[[nodiscard]] std::vector<RegionLook> look_at(std::span<const ColourRegion> regions, const optics::Surface& surface,
                                              std::span<const Eigen::Vector3f> near_target,
                                              std::span<const Eigen::Vector3f> near);

}  // namespace voxtone::halftone

// SPDX-License-Identifier: GPL-3.0-or-later
//
// From where each cell of a print can be seen, and how much that counts.
//
// A person who looks at cell i from direction w sees of it a_i (n_i . w), if nothing of the body is between. Directions
// are drawn about the normal by the cosine law, so that each counts as much as it shows; with K of them
//
//   n_is = how many of them leave the body towards side s,     v_i = sum_s q_s n_is / K
//
// From more than 45 degrees above the horizon is from the top, from more than 15 below it from the bottom; between,
// front (-y), back, left (-x) and right. Prints stand as they are laid: q = 1 but for the bottom, 1/8: who walks around
// a table sees all else, and the underside when he takes it up. So a free place that looks up has v = 1, an upright
// wall 0.71, the underside 0.18, the inside of a cup what its mouth leaves.
//
// Rays (Embree) start half a cell above the surface, so that the steps of cells do not shade each other; K = 24, each
// cell's set turned by itself: v of one cell has a standard error of some 0.07, of a region of a hundred nothing to
// speak of. A picture's slab is seen from the top alone. Time: some 6 core-seconds for a million cells (67 cm2).
// What it cannot see: that the body is printed in another position than it will stand in.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/named_values.h"
#include "base/progress.h"
#include "optics/scene/surface.h"
#include "slicer/part/job_body.h"

namespace voxtone::slicer {

enum class Side { front, back, left, right, top, bottom };
inline constexpr std::size_t all_sides = 6;

class SidesSeen {
public:
    static constexpr std::size_t directions = 24;
    static constexpr double from_below = 0.125;

    SidesSeen() = default;
    /// Throws ResourceError where Embree cannot start, Cancelled.
    SidesSeen(const JobBody& body, const optics::Surface& surface, const Progress& progress);

    /// v.
    [[nodiscard]] double weight(std::size_t cell) const;
    /// n_is / K.
    [[nodiscard]] double from(Side side, std::size_t cell) const;
    /// The side from which most is seen of these cells together, by q.
    [[nodiscard]] Side main_side(std::span<const std::uint32_t> cells) const;

private:
    std::vector<std::array<std::uint8_t, all_sides>> count_;
};

/// Area times v, per cell.
[[nodiscard]] std::vector<double> seen_areas(const optics::Surface& surface, const SidesSeen& sides);

/// "from the front", "from below".
[[nodiscard]] const char* from_words(Side side);

}  // namespace voxtone::slicer

template <>
struct voxtone::NamesOf<voxtone::slicer::Side> {
    using E = slicer::Side;
    static constexpr auto table = std::to_array<Named<E>>({{E::front, "front"},
                                                           {E::back, "back"},
                                                           {E::left, "left"},
                                                           {E::right, "right"},
                                                           {E::top, "top"},
                                                           {E::bottom, "bottom"}});
};

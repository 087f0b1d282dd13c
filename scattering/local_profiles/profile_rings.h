// SPDX-License-Identifier: GPL-3.0-or-later
//
// The window around a point as rings: offsets of the same length, at which a local profile has one value.
//
// A profile has a knot at every whole distance 0, 1, ..., radius (in points); its logarithm runs straight between them.
// So a ring of radius r reads ln P(r) = low_share ln P(knot) + (1 - low_share) ln P(knot + 1).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "optics/monte_carlo/sampled_bssrdf.h"

namespace voxtone::scattering {

struct ProfileRing {
    double radius = 0;  ///< points
    std::size_t knot = 0;
    double low_share = 1;
    std::vector<optics::PointOffset> offsets;  ///< both of each pair of opposite ones; (0, 0) once
};

/// By radius; the first is the point itself. radius >= 1.
[[nodiscard]] std::vector<ProfileRing> profile_rings(std::uint32_t radius);

/// By offset of the half window: which ring it lies in.
[[nodiscard]] std::vector<std::size_t> rings_of_half_window(std::span<const ProfileRing> rings, std::uint32_t radius);

/// A grid of points.
struct PointGrid {
    std::uint32_t width = 0, height = 0;
    [[nodiscard]] std::size_t points() const { return std::size_t{width} * height; }
};

/// Adds up, for each point of a row, the values at the offsets of a ring; nothing outside of the grid. `sum` is one
/// row.
void sum_over_ring(const PointGrid& grid, const ProfileRing& ring, std::span<const double> image, std::uint32_t row,
                   std::span<double> sum);

/// Rows of points that one task takes.
inline constexpr std::size_t rows_per_task = 8;

}  // namespace voxtone::scattering

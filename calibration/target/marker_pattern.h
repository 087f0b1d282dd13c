// SPDX-License-Identifier: GPL-3.0-or-later
//
// The squares by which a photograph of a target finds itself: ArUco markers of 5 x 5 bits in a dark border one cell
// wide. S. Garrido-Jurado et al., "Generation of fiducial marker dictionaries using mixed integer linear programming",
// 2016 (OpenCV's DICT_5X5_1000). No marker of the dictionary is another one turned, so each tells which way up it is.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace voxtone::calibration {

inline constexpr std::string_view marker_dictionary = "DICT_5X5_1000";
inline constexpr int marker_count = 1000;
/// Cells along an edge, border included.
inline constexpr int marker_cells = 7;

/// Cells of marker `id` in [0, marker_count), row by row from the top left: true is dark.
[[nodiscard]] std::vector<bool> marker_pattern(int id);

/// A marker in a picture.
struct MarkerView {
    int id = 0;
    std::array<Eigen::Vector2d, 4> corners;  ///< px: upper left, upper right, lower right, lower left of the marker
};

/// Markers of the dictionary in an 8-bit grey picture, row by row without gaps; `inverted`: light ones on dark, too.
[[nodiscard]] std::vector<MarkerView> markers_in(std::span<const std::uint8_t> grey, int width, int height,
                                                 bool inverted);

}  // namespace voxtone::calibration

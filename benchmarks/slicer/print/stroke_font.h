// SPDX-License-Identifier: GPL-3.0-or-later
//
// A plain typeface of lines of one width with round ends, drawn for this benchmark: lower case, digits, a few capitals
// and marks. Em 10 units, x-height 5, ascenders 7, descenders -2, line width 0.95 units.
#pragma once

#include <string>
#include <vector>

namespace voxtone::loop_benchmark {

struct Stroke {
    double x0, y0, x1, y1;  ///< mm; a dot where both ends are one
    double width;
};

inline constexpr double mm_per_point = 25.4 / 72;

/// Adds a line of text whose baseline starts at (x, y); y points up. Characters that the face lacks are blanks. Returns
/// where the next character would start.
double add_text(std::vector<Stroke>& strokes, const std::string& text, double x, double y, double point_size);

/// Coverage of pixels of 1 / px_per_mm, rows from the top, the first one at y = height_mm: share of 4 x 4 samples.
[[nodiscard]] std::vector<float> draw_strokes(const std::vector<Stroke>& strokes, double width_mm, double height_mm,
                                              double px_per_mm);

}  // namespace voxtone::loop_benchmark

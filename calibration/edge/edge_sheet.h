// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where things lie on the printed sheet of an edge measurement (A4, mm, y down from its upper left corner): a
// checkerboard of 20 mm squares, four fiducials in the corners, a line of 100 mm. `edge samples` draws it, simulated
// photographs show it.
#pragma once

#include <cmath>

namespace voxtone::calibration {

struct EdgeSheetLayout {
    static constexpr double width = 210, height = 297;
    static constexpr double square = 20, left = 35, top = 30;  ///< of the board
    static constexpr int columns = 7, rows = 11;
    static constexpr double fiducial = 14, fiducial_margin = 10;
    static constexpr double scale_left = 55, scale_y = 262, scale_length = 100;
    /// Middle of the edge in the middle of the board: black lies left of it, white right.
    static constexpr double edge_x = left + 4 * square, edge_y = top + 5.5 * square;

    /// The upper left square is black.
    [[nodiscard]] static constexpr bool black(int column, int row) { return (column + row) % 2 == 0; }
};

}  // namespace voxtone::calibration

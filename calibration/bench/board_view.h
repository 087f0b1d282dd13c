// SPDX-License-Identifier: GPL-3.0-or-later
//
// Finds the printed checkerboard in a photograph, although a slab covers its middle: where its squares lie, how many
// pixels a mm has, and the edge that is measured, the upright one nearest to the middle of the picture.
//
// Crossings of squares are maxima of a ring response (S. Bennett, J. Lasenby, ChESS - quick and robust detection of
// chess-board features, CVIU 118, 2014) in a smaller picture; the square lattice that explains most of them is refined
// to a homography through sub-pixel corners at full size, outliers (crossings under the slab or at its rim) left out.
// Cannot see: lens distortion, other than as a residual.
#pragma once

#include "calibration/photo/rectify.h"
#include "io/pictures/photograph.h"

namespace voxtone::calibration {

struct BoardView {
    /// From mm of the sheet: (0, 0) is the middle of the edge, x grows from its black to its white side, y along it.
    Rectification place;
    double px_per_mm = 0;    ///< at the edge
    double residual_px = 0;  ///< root mean square of the corners about the homography
    int corners = 0;
    double turn_deg = 0;  ///< of the edge from the picture's upright
    double tilt_deg = 0;  ///< of the camera from straight above, as far as squares are not square
};

/// Linear samples. Throws InputError where there is no board, its edge is turned too far from upright or seen from
/// aside.
[[nodiscard]] BoardView find_board(const io::Photograph& photograph, double square_mm = 20);

}  // namespace voxtone::calibration

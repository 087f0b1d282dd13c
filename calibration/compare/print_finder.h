// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a print may lie in its photograph: things with four corners that differ from the ground around them.
//
// The ground's colour is a plane over the picture, fitted to a band along its border; a pixel differs by how far its
// code values lie from that. Sides are lines through the edge's points, corners their crossings: blur rounds a corner,
// it does not move an edge. Cannot tell a print from ground of its own colour, nor from a second thing that touches
// it; which of them is the print the prediction tells (print_place.h).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "calibration/photo/rectify.h"
#include "io/pictures/photograph.h"

namespace voxtone::calibration {

using PrintCorners = std::array<Eigen::Vector2d, 4>;  ///< px, clockwise as seen

/// The largest first, one at least. `photograph`: linear. Throws InputError that says what to try.
[[nodiscard]] std::vector<PrintCorners> find_prints(const io::Photograph& photograph);

/// The largest thing that differs from the ground, without its holes, in a picture whose pixels are `reduced` of the
/// photograph's.
struct Silhouette {
    enum Part : std::uint8_t { ground, thing, thing_or_its_shadow };  ///< the last: darker than ground, of its colour
    int columns = 0, rows = 0;
    double reduced = 1;
    std::vector<std::uint8_t> part;
};
/// Throws InputError that says what to try.
[[nodiscard]] Silhouette find_silhouette(const io::Photograph& photograph);

/// Corners by hand, in any order round it. Throws InputError where they are no four-sided figure in the picture.
[[nodiscard]] PrintCorners checked_corners(const io::Photograph& photograph, const PrintCorners& corners);

}  // namespace voxtone::calibration

// SPDX-License-Identifier: GPL-3.0-or-later
//
// A photograph after the correction of its light and colours, small enough to look at, to draw on what was found in it.
// Places are the photograph's pixels, the corner of the first at (0, 0).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>

#include "calibration/photo/light_field.h"
#include "calibration/photo/rectify.h"
#include "calibration/target/target_layout.h"
#include "io/pictures/photograph.h"
#include "io/pictures/picture_writer.h"

namespace voxtone::calibration {

using OverlayColour = std::array<std::uint8_t, 3>;  ///< sRGB codes

class Overlay {
public:
    /// The longest side has at most `longest_px`.
    Overlay(const io::Photograph& photograph, const PhotoModel& model, int longest_px);
    /// On another picture, whose pixels are `scale` of the photograph's.
    Overlay(io::Picture8 picture, double scale);

    void line(const Eigen::Vector2d& from_px, const Eigen::Vector2d& to_px, const OverlayColour& colour, int width = 1);
    /// The sides of a rectangle on the plane that was photographed.
    void box(const Rectification& place, const Area& area, const OverlayColour& colour, int width = 1);
    /// Two lines through the middle of a square on that plane, along its sides.
    void cross(const Rectification& place, const Area& area, const OverlayColour& colour);
    /// One pixel of the picture; nothing where it is outside.
    void dot(const Eigen::Vector2d& px, const OverlayColour& colour);
    /// Its middle about there.
    void text(const Eigen::Vector2d& middle_px, const std::string& text, const OverlayColour& colour);

    [[nodiscard]] const io::Picture8& picture() const { return picture_; }

private:
    io::Picture8 picture_;
    double scale_ = 1;
};

}  // namespace voxtone::calibration

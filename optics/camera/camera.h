// SPDX-License-Identifier: GPL-3.0-or-later
//
// A pinhole camera: everything is sharp. Its picture plane is square to the line of sight; x to the right, y downward.
#pragma once

#include <array>

#include "optics/scene/boundary.h"

namespace voxtone::optics {

struct CameraView {
    Point position{0, -100, 0}, target{};  ///< mm
    Point up{0, 0, 1};                     ///< upward in the picture
    double focal_mm = 85;                  ///< of a camera whose frame is 36 mm wide (small-picture film); > 0
    int width_px = 800, height_px = 600;
};

class Camera {
public:
    /// Throws InputError where position and target are the same place, or `up` lies along the line between them.
    explicit Camera(const CameraView& view);

    /// The direction, unit length, in which a place of the picture lies: pixels from its upper left corner.
    [[nodiscard]] Point direction(double x_px, double y_px) const;
    [[nodiscard]] const Point& position() const { return position_; }
    [[nodiscard]] int width_px() const { return width_; }
    [[nodiscard]] int height_px() const { return height_; }
    /// Pixels from the upper left corner of what lies at p; p before the camera.
    [[nodiscard]] std::array<double, 2> picture_of(const Point& p) const;

private:
    Point position_, forward_, right_, down_;
    double pixel_;  ///< edge at unit distance
    int width_, height_;
};

/// Frame of small-picture film, mm: focal lengths are given for it.
inline constexpr double film_width_mm = 36;

}  // namespace voxtone::optics

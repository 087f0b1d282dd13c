// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/camera/camera.h"

#include <cmath>

#include "base/contracts.h"
#include "base/error.h"

namespace voxtone::optics {
namespace {

Point unit(const Point& p, const char* why_not) {
    const double length = std::sqrt(dot(p, p));
    if (!(length > 1e-9)) throw InputError(why_not);
    return {p[0] / length, p[1] / length, p[2] / length};
}

}  // namespace

Camera::Camera(const CameraView& view) : position_(view.position), width_(view.width_px), height_(view.height_px) {
    VOXTONE_EXPECT(view.focal_mm > 0 && width_ > 0 && height_ > 0);
    Point ahead{};
    for (std::size_t a = 0; a < 3; ++a) ahead[a] = view.target[a] - view.position[a];
    forward_ = unit(ahead, "The camera stands at the place that it looks at; move one of them.");
    right_ = unit(cross(forward_, view.up), "The camera looks along the direction that is to be up in its picture.");
    down_ = cross(forward_, right_);
    pixel_ = film_width_mm / view.focal_mm / width_;
}

Point Camera::direction(double x_px, double y_px) const {
    const double x = (x_px - 0.5 * width_) * pixel_, y = (y_px - 0.5 * height_) * pixel_;
    const double scale = 1 / std::sqrt(1 + x * x + y * y);
    Point d{};
    for (std::size_t a = 0; a < 3; ++a) d[a] = scale * (forward_[a] + x * right_[a] + y * down_[a]);
    return d;
}

std::array<double, 2> Camera::picture_of(const Point& p) const {
    Point r{};
    for (std::size_t a = 0; a < 3; ++a) r[a] = p[a] - position_[a];
    const double depth = dot(r, forward_);
    VOXTONE_EXPECT(depth > 0);
    return {0.5 * width_ + dot(r, right_) / depth / pixel_, 0.5 * height_ + dot(r, down_) / depth / pixel_};
}

}  // namespace voxtone::optics

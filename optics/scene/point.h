// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points and directions, mm.
#pragma once

#include <array>
#include <cstddef>

namespace voxtone::optics {

using Point = std::array<double, 3>;

[[nodiscard]] inline double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

[[nodiscard]] inline Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// from + distance * way
[[nodiscard]] inline Point along(const Point& from, const Point& way, double distance) {
    return {from[0] + distance * way[0], from[1] + distance * way[1], from[2] + distance * way[2]};
}

}  // namespace voxtone::optics

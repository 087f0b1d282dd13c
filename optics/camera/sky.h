// SPDX-License-Identifier: GPL-3.0-or-later
//
// Light from far away, from every direction, as a picture of the sphere: rows from the zenith (+z) to the nadir,
// columns around from +x over +y. Radiance is the same within a pixel, so that a direction drawn by luminance has
// exactly the density that the picture says.
//
// Unit: 1 is the radiance of a perfect diffuser that lies in the open and looks up (`normalised`).
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "optics/scene/boundary.h"

namespace voxtone::optics {

/// Linear sRGB.
using Light = std::array<double, 3>;

class Sky {
public:
    /// `radiance`: rows from the zenith, columns * rows; all >= 0 and finite, some above 0.
    Sky(std::size_t columns, std::size_t rows, std::vector<Light> radiance);

    /// Radiance from where `direction` (unit length) points.
    [[nodiscard]] const Light& radiance(const Point& direction) const { return radiance_[pixel_of(direction)]; }

    /// Directions drawn by luminance; three numbers in [0, 1).
    [[nodiscard]] Point draw(double pixel, double u, double v) const;
    /// Their density per steradian.
    [[nodiscard]] double density(const Point& direction) const;

    /// Irradiance on a plane that looks along `normal`, per channel.
    [[nodiscard]] Light irradiance(const Point& normal) const;
    [[nodiscard]] bool grey() const { return grey_; }

    /// Scaled so that the luminance on a plane that looks up is pi.
    [[nodiscard]] Sky normalised() const;
    /// Turned around the vertical, counter-clockwise from above, by whole columns.
    [[nodiscard]] Sky turned(double degrees) const;

private:
    [[nodiscard]] std::size_t pixel_of(const Point& direction) const;
    [[nodiscard]] Point direction_of(std::size_t pixel, double u, double v) const;

    std::size_t columns_, rows_;
    std::vector<Light> radiance_;
    std::vector<double> share_;      ///< running, of all light; the last is 1
    std::vector<double> row_solid_;  ///< steradians of a pixel, per row
    bool grey_ = true;
};

[[nodiscard]] double luminance(const Light& light);

/// A sky from a function of the direction, averaged over each pixel.
[[nodiscard]] Sky sky_of(const std::function<Light(const Point&)>& radiance, std::size_t columns = 512,
                         std::size_t rows = 256);

/// The same from everywhere, above and below: a furnace. Radiance 1.
[[nodiscard]] Sky even_sky();
/// CIE Standard Overcast Sky (CIE S 011/E:2003, type 1, in its older form by Moon and Spencer 1942): (1 + 2 sin h) / 3
/// of the zenith's at the height h; nothing from below the horizon. Normalised.
[[nodiscard]] Sky overcast_sky();
/// A studio: a large soft box from the left, the front (-y) and above, a weaker one from the right, and white walls.
/// Normalised.
[[nodiscard]] Sky studio_sky();

}  // namespace voxtone::optics

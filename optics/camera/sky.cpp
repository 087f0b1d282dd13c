// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/camera/sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/contracts.h"

namespace voxtone::optics {
namespace {

using std::numbers::pi;

Point from_angles(double azimuth_deg, double height_deg) {
    const double a = azimuth_deg * pi / 180, h = height_deg * pi / 180;
    return {std::cos(h) * std::cos(a), std::cos(h) * std::sin(a), std::sin(h)};
}

}  // namespace

double luminance(const Light& light) {  // of linear sRGB (IEC 61966-2-1)
    return 0.2126 * light[0] + 0.7152 * light[1] + 0.0722 * light[2];
}

Sky::Sky(std::size_t columns, std::size_t rows, std::vector<Light> radiance)
    : columns_(columns), rows_(rows), radiance_(std::move(radiance)) {
    VOXTONE_EXPECT(columns > 0 && rows > 0 && radiance_.size() == columns * rows);
    row_solid_.resize(rows);
    for (std::size_t r = 0; r < rows; ++r)
        row_solid_[r] = 2 * pi / double(columns) *
                        (std::cos(pi * double(r) / double(rows)) - std::cos(pi * double(r + 1) / double(rows)));
    share_.resize(radiance_.size());
    double sum = 0;
    for (std::size_t i = 0; i < radiance_.size(); ++i) {
        const Light& light = radiance_[i];
        for (const double x : light) VOXTONE_EXPECT(std::isfinite(x) && x >= 0);
        grey_ = grey_ && light[0] == light[1] && light[1] == light[2];
        sum += luminance(light) * row_solid_[i / columns];
        share_[i] = sum;
    }
    VOXTONE_EXPECT(sum > 0);
    for (double& s : share_) s /= sum;
    share_.back() = 1;
}

std::size_t Sky::pixel_of(const Point& d) const {
    const double from_zenith = std::acos(std::clamp(d[2], -1.0, 1.0)) / pi, around = std::atan2(d[1], d[0]) / (2 * pi);
    const auto row = std::min(static_cast<std::size_t>(from_zenith * double(rows_)), rows_ - 1);
    const auto column =
        std::min(static_cast<std::size_t>((around < 0 ? around + 1 : around) * double(columns_)), columns_ - 1);
    return row * columns_ + column;
}

Point Sky::direction_of(std::size_t pixel, double u, double v) const {
    const std::size_t row = pixel / columns_, column = pixel % columns_;
    const double low = std::cos(pi * double(row) / double(rows_)),
                 high = std::cos(pi * double(row + 1) / double(rows_));
    const double z = low + v * (high - low), across = std::sqrt(std::max(0.0, 1 - z * z));
    const double around = 2 * pi * (double(column) + u) / double(columns_);
    return {across * std::cos(around), across * std::sin(around), z};
}

Point Sky::draw(double pixel, double u, double v) const {
    const auto at = std::upper_bound(share_.begin(), share_.end() - 1, pixel);
    return direction_of(static_cast<std::size_t>(at - share_.begin()), u, v);
}

double Sky::density(const Point& direction) const {
    const std::size_t pixel = pixel_of(direction);
    return (share_[pixel] - (pixel > 0 ? share_[pixel - 1] : 0.0)) / row_solid_[pixel / columns_];
}

Light Sky::irradiance(const Point& normal) const {
    Light sum{};
    for (std::size_t i = 0; i < radiance_.size(); ++i) {
        constexpr int parts = 2;
        double cosine = 0;
        for (int k = 0; k < parts * parts; ++k)
            cosine += std::max(0.0, dot(normal, direction_of(i, (k % parts + 0.5) / parts, (k / parts + 0.5) / parts)));
        const double weight = cosine / (parts * parts) * row_solid_[i / columns_];
        for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * radiance_[i][c];
    }
    return sum;
}

Sky Sky::normalised() const {
    const double scale = pi / luminance(irradiance({0, 0, 1}));
    VOXTONE_EXPECT(std::isfinite(scale));
    std::vector<Light> scaled = radiance_;
    for (Light& light : scaled)
        for (double& x : light) x *= scale;
    return {columns_, rows_, std::move(scaled)};
}

Sky Sky::turned(double degrees) const {
    const auto columns = static_cast<double>(columns_);
    const double shift = std::fmod(std::round(degrees / 360 * columns), columns);
    const auto by = static_cast<std::size_t>(shift < 0 ? shift + columns : shift);
    std::vector<Light> moved(radiance_.size());
    for (std::size_t i = 0; i < moved.size(); ++i)
        moved[i / columns_ * columns_ + (i % columns_ + by) % columns_] = radiance_[i];
    return {columns_, rows_, std::move(moved)};
}

Sky sky_of(const std::function<Light(const Point&)>& radiance, std::size_t columns, std::size_t rows) {
    constexpr int parts = 4;
    std::vector<Light> pixels(columns * rows);
    for (std::size_t i = 0; i < pixels.size(); ++i)
        for (int k = 0; k < parts * parts; ++k) {
            const double x = double(i % columns) + (k % parts + 0.5) / parts;
            const double y = double(i / columns) + (k / parts + 0.5) / parts;
            const double zenith = pi * y / double(rows), around = 2 * pi * x / double(columns);
            const Light light =
                radiance({std::sin(zenith) * std::cos(around), std::sin(zenith) * std::sin(around), std::cos(zenith)});
            for (std::size_t c = 0; c < 3; ++c) pixels[i][c] += light[c] / (parts * parts);
        }
    return {columns, rows, std::move(pixels)};
}

Sky even_sky() { return {1, 1, {Light{1, 1, 1}}}; }

Sky overcast_sky() {
    return sky_of([](const Point& d) {
               const double light = d[2] > 0 ? (1 + 2 * d[2]) / 3 : 0.0;
               return Light{light, light, light};
           })
        .normalised();
}

Sky studio_sky() {
    // A soft box is what lies within these angles of its middle, its edge as soft as a frosted cloth's.
    struct Box {
        Point middle;
        double half_width_deg, radiance;
    };
    static const std::array<Box, 2> boxes{{{from_angles(-130, 48), 40, 2.4}, {from_angles(-30, 30), 30, 1.2}}};
    constexpr double edge_deg = 12, walls = 0.5;
    return sky_of([](const Point& d) {
               double light = d[2] > 0 ? walls : 0.0;
               for (const Box& box : boxes) {
                   const double off_deg = std::acos(std::clamp(dot(d, box.middle), -1.0, 1.0)) * 180 / pi;
                   light += box.radiance * std::clamp((box.half_width_deg - off_deg) / edge_deg + 0.5, 0.0, 1.0);
               }
               return Light{light, light, light};
           })
        .normalised();
}

}  // namespace voxtone::optics

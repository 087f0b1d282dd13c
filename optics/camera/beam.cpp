// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/camera/beam.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/contracts.h"

namespace voxtone::optics {
namespace {

using std::numbers::pi;

Point from_to(const Point& a, const Point& b) { return {b[0] - a[0], b[1] - a[1], b[2] - a[2]}; }

}  // namespace

Beam::Beam(const BeamKind& kind, std::vector<BeamPlane> planes) : kind_(kind), planes_(std::move(planes)) {
    VOXTONE_EXPECT(!planes_.empty() && kind.times > 0 && (kind.shape == BeamShape::edge || kind.width_mm > 0));
    VOXTONE_EXPECT(kind.tilt_deg >= 0 && kind.half_angle_deg > 0 && kind.tilt_deg + kind.half_angle_deg < 90);
    const double tilt = kind.tilt_deg * pi / 180, rim = kind.half_angle_deg * pi / 180;
    rim_cosine_ = std::cos(rim);
    // A cone that is all above the plane sends pi sin^2(rim) cos(tilt) of its radiance to it.
    lit_.fill(kind.times / (std::sin(rim) * std::sin(rim) * std::cos(tilt)));
    for (const BeamPlane& plane : planes_) {
        Point& lamp = lamps_.emplace_back();
        for (std::size_t a = 0; a < 3; ++a)
            lamp[a] = std::cos(tilt) * plane.normal[a] + std::sin(tilt) * plane.along[a];
    }
}

bool Beam::in_lamp(std::size_t plane, const Point& way) const { return dot(way, lamps_[plane]) > rim_cosine_; }

double Beam::outside_mm(const BeamPlane& plane, const Point& at) const {
    const Point off = from_to(plane.place, at);
    const double along = dot(off, plane.along), across = dot(off, cross(plane.normal, plane.along));
    switch (kind_.shape) {
        case BeamShape::edge:
            return -across;
        case BeamShape::slit:
            return std::abs(across) - 0.5 * kind_.width_mm;
        case BeamShape::spot:
            return std::sqrt(along * along + across * across) - 0.5 * kind_.width_mm;
    }
    return 0;
}

const Light& Beam::radiance(const Point& from, const Point& way) const {
    for (std::size_t k = 0; k < planes_.size(); ++k) {
        if (!in_lamp(k, way)) continue;
        const BeamPlane& plane = planes_[k];
        const double distance = dot(from_to(from, plane.place), plane.normal) / dot(way, plane.normal);
        Point at{};
        for (std::size_t a = 0; a < 3; ++a) at[a] = from[a] + distance * way[a];
        if (outside_mm(plane, at) < 0) return lit_;
    }
    return dark_;
}

Point Beam::draw(double which, double u, double v) const {
    const auto count = static_cast<double>(planes_.size());
    const std::size_t k = std::min(static_cast<std::size_t>(which * count), planes_.size() - 1);
    const double cosine = 1 - u * (1 - rim_cosine_), sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const double phi = 2 * pi * v;
    const Point& lamp = lamps_[k];
    const Point side = cross(planes_[k].normal, planes_[k].along), other = cross(lamp, side);  // both square to it
    Point way{};
    for (std::size_t a = 0; a < 3; ++a)
        way[a] = cosine * lamp[a] + sine * (std::cos(phi) * side[a] + std::sin(phi) * other[a]);
    return way;
}

double Beam::density(const Point& way) const {
    std::size_t hit = 0;
    for (std::size_t k = 0; k < planes_.size(); ++k) hit += in_lamp(k, way) ? 1 : 0;
    return static_cast<double>(hit) / (static_cast<double>(planes_.size()) * 2 * pi * (1 - rim_cosine_));
}

}  // namespace voxtone::optics

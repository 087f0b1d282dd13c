// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/decal.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace voxtone::io {

namespace {

constexpr float no_depth = std::numeric_limits<float>::infinity();

/// Least and most of the four finite depths around a place; {inf, -inf}: there is none.
std::pair<float, float> depths_near(const DepthMap& map, float along, float up) {
    const auto cell = [](float share, std::uint32_t points) {
        return std::min(static_cast<std::uint32_t>(std::max(0.0f, share * float(points - 1))), points - 2);
    };
    const std::uint32_t i = cell(along, map.columns), j = cell(up, map.rows);
    std::pair<float, float> range{no_depth, -no_depth};
    for (const std::uint32_t b : {j, j + 1})
        for (const std::uint32_t a : {i, i + 1})
            if (const float depth = map.depth_mm[std::size_t{b} * map.columns + a]; std::isfinite(depth))
                range = {std::min(range.first, depth), std::max(range.second, depth)};
    return range;
}

}  // namespace

float DepthMap::deepest_near(float along, float up) const {
    const float deepest = depths_near(*this, along, up).second;
    return std::isfinite(deepest) ? deepest : no_depth;
}

Eigen::Vector4f Decal::picture_at(double along, double up_share, double spacing) const {
    const double pixel = std::max(width_mm / picture->width_px(), height_mm / picture->height_px());
    return picture->sample(float(along * picture->width_px()), float((1 - up_share) * picture->height_px()),
                           float(std::log2(spacing / pixel)));
}

Eigen::Vector4f Decal::at(const Eigen::Vector3d& point_mm, const Eigen::Vector3d& normal,
                          double sample_spacing_mm) const {
    const Eigen::Vector3d offset = point_mm - corner_mm;
    const double along = right.dot(offset) / width_mm, up_share = up.dot(offset) / height_mm;
    if (!(along >= 0 && along <= 1 && up_share >= 0 && up_share <= 1)) return Eigen::Vector4f::Zero();
    if (std::abs(normal.dot(out)) < least_cos) return Eigen::Vector4f::Zero();
    if (first_hit.columns > 0) {
        // What lies above all of it is no part of the body that was looked at.
        const auto [least, most] = depths_near(first_hit, float(along), float(up_share));
        const double depth = -out.dot(offset);
        if (!(depth >= double(least) - slack_mm && depth <= double(most) + slack_mm)) return Eigen::Vector4f::Zero();
    }
    return picture_at(along, up_share, sample_spacing_mm);
}

Eigen::Vector4f Decal::at_uv(const Eigen::Vector2f& uv, double spacing) const {
    const double along = (uv.x() - corner_mm.x()) / width_mm, up_share = (uv.y() - corner_mm.y()) / height_mm;
    if (!(along >= 0 && along <= 1 && up_share >= 0 && up_share <= 1)) return Eigen::Vector4f::Zero();
    return picture_at(along, up_share, spacing);
}

}  // namespace voxtone::io

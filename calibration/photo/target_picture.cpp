// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/photo/target_picture.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace voxtone::calibration {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Mean of the photograph's pixels whose middles lie within half of `side_px` of a point, at least the one that holds
/// it; none outside.
std::optional<Vector3d> mean_around(const io::Photograph& photo, const Vector2d& px, double side_px) {
    if (px.x() < 0 || px.y() < 0 || px.x() >= photo.width_px || px.y() >= photo.height_px) return std::nullopt;
    const auto range = [&](double at, std::uint32_t count) {
        const auto of = [&](double x) { return std::uint32_t(std::clamp(std::floor(x), 0.0, double(count) - 1)); };
        const std::uint32_t first = of(at - (side_px - 1) / 2), last = of(at + (side_px - 1) / 2);
        return side_px > 1 ? std::pair{first, last} : std::pair{of(at), of(at)};
    };
    const auto [left, right] = range(px.x(), photo.width_px);
    const auto [top, bottom] = range(px.y(), photo.height_px);
    Vector3d sum = Vector3d::Zero();
    for (std::uint32_t y = top; y <= bottom; ++y)
        for (std::uint32_t x = left; x <= right; ++x) sum += photo.pixels[photo.index(x, y)].cast<double>();
    return sum / double((right - left + 1) * (bottom - top + 1));
}

}  // namespace

TargetPicture::TargetPicture(const Target& target) : size_mm_(target.size_mm) {
    constexpr double most_px_per_mm = 8, longest_px = 1000;
    const double px_per_mm = std::min(most_px_per_mm, longest_px / size_mm_.maxCoeff());
    const auto pixels = [&](double mm) { return std::uint32_t(std::max(1.0, std::round(mm * px_per_mm))); };
    width_px_ = pixels(size_mm_.x());
    height_px_ = pixels(size_mm_.y());
    sums_.assign(std::size_t{width_px_} * height_px_, Eigen::Vector4d::Zero());
}

Vector2d TargetPicture::place_mm(std::uint32_t column, std::uint32_t row) const {
    return {(column + 0.5) / width_px_ * size_mm_.x(), (1 - (row + 0.5) / height_px_) * size_mm_.y()};
}

void TargetPicture::add(const PhotoMeasurement& m) {
    for (std::uint32_t row = 0; row < height_px_; ++row)
        for (std::uint32_t column = 0; column < width_px_; ++column) {
            const Vector2d mm = place_mm(column, row), px = m.view.place.to_px(mm);
            const double side_px = m.view.place.px_per_unit(mm) * size_mm_.x() / width_px_;
            const std::optional<Vector3d> value = mean_around(m.photograph, px, side_px);
            if (!value) continue;
            const Vector3d rho = m.model.reflectance(px, *value);
            sums_[std::size_t{row} * width_px_ + column] += Eigen::Vector4d(rho[0], rho[1], rho[2], 1);
        }
}

io::Picture8 TargetPicture::mean() const {
    io::LinearPicture picture{width_px_, height_px_, {}};
    picture.pixels.reserve(sums_.size());
    for (const Eigen::Vector4d& sum : sums_) {
        const Vector3d rho = sum[3] > 0 ? Vector3d(sum.head<3>() / sum[3]) : Vector3d(Vector3d::Zero());
        const Eigen::Vector3f shown = rho.cwiseMax(0).cwiseMin(1).cast<float>();
        picture.pixels.emplace_back(shown[0], shown[1], shown[2], sum[3] > 0 ? 1.0f : 0.0f);
    }
    return io::encode_transparent(picture);
}

}  // namespace voxtone::calibration

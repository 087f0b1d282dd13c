// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/photo/overlay.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "io/pictures/srgb_code.h"

namespace voxtone::calibration {
namespace {

using Eigen::Vector2d;

cv::Mat mat_of(io::Picture8& picture) {
    return {int(picture.height_px), int(picture.width_px), CV_8UC3, picture.codes.data()};
}

cv::Scalar scalar_of(const OverlayColour& colour) { return {double(colour[0]), double(colour[1]), double(colour[2])}; }

constexpr int sixteenths = 4;  // binary digits behind the point: of a pixel

cv::Point fine(const Vector2d& px, double scale) {
    const Vector2d p = (px * scale - Vector2d(0.5, 0.5)) * (1 << sixteenths);
    return {int(std::lround(p.x())), int(std::lround(p.y()))};
}

cv::Mat made_small(const io::Photograph& photo, double scale) {
    const cv::Mat whole(int(photo.height_px), int(photo.width_px), CV_32FC3,
                        const_cast<Eigen::Vector3f*>(photo.pixels.data()));
    cv::Mat small;
    cv::resize(whole, small, {}, scale, scale, cv::INTER_AREA);
    return small;
}

}  // namespace

Overlay::Overlay(const io::Photograph& photo, const PhotoModel& model, int longest_px)
    : scale_(std::min(1.0, double(longest_px) / std::max(photo.width_px, photo.height_px))) {
    const cv::Mat small = made_small(photo, scale_);
    picture_ = {std::uint32_t(small.cols), std::uint32_t(small.rows), 3, {}};
    picture_.codes.reserve(3 * small.total());
    for (int y = 0; y < small.rows; ++y)
        for (int x = 0; x < small.cols; ++x) {
            const auto& value = small.at<cv::Vec3f>(y, x);
            const Eigen::Vector3d rho =
                model.reflectance(Vector2d(x + 0.5, y + 0.5) / scale_, {value[0], value[1], value[2]});
            for (const double part : rho)
                picture_.codes.push_back(io::linear_to_srgb8(float(std::clamp(part, 0.0, 1.0))));
        }
}

Overlay::Overlay(io::Picture8 picture, double scale) : picture_(std::move(picture)), scale_(scale) {}

void Overlay::line(const Vector2d& from_px, const Vector2d& to_px, const OverlayColour& colour, int width) {
    cv::Mat mat = mat_of(picture_);
    cv::line(mat, fine(from_px, scale_), fine(to_px, scale_), scalar_of(colour), width, cv::LINE_AA, sixteenths);
}

void Overlay::box(const Rectification& place, const Area& area, const OverlayColour& colour, int width) {
    const auto &low = area.min_mm, &high = area.max_mm;
    const std::array corners{low, Vector2d(high.x(), low.y()), high, Vector2d(low.x(), high.y())};
    for (std::size_t k = 0; k < 4; ++k) line(place.to_px(corners[k]), place.to_px(corners[(k + 1) % 4]), colour, width);
}

void Overlay::cross(const Rectification& place, const Area& area, const OverlayColour& colour) {
    const Vector2d middle = area.center();
    line(place.to_px({area.min_mm.x(), middle.y()}), place.to_px({area.max_mm.x(), middle.y()}), colour);
    line(place.to_px({middle.x(), area.min_mm.y()}), place.to_px({middle.x(), area.max_mm.y()}), colour);
}

void Overlay::dot(const Vector2d& px, const OverlayColour& colour) {
    const Vector2d p = px * scale_;
    const auto x = std::lround(p.x() - 0.5), y = std::lround(p.y() - 0.5);
    if (x < 0 || y < 0 || x >= long(picture_.width_px) || y >= long(picture_.height_px)) return;
    std::copy(colour.begin(), colour.end(),
              picture_.codes.begin() + std::ptrdiff_t(3) * (std::ptrdiff_t(y) * picture_.width_px + x));
}

void Overlay::text(const Vector2d& middle_px, const std::string& text, const OverlayColour& colour) {
    constexpr double size = 0.5;
    constexpr int half_letter = 5;  // px of that size, across and up
    const Vector2d at = middle_px * scale_;
    cv::Mat mat = mat_of(picture_);
    cv::putText(mat, text, {int(at.x()) - half_letter * int(text.size()), int(at.y()) + half_letter},
                cv::FONT_HERSHEY_SIMPLEX, size, scalar_of(colour), 1, cv::LINE_AA);
}

}  // namespace voxtone::calibration

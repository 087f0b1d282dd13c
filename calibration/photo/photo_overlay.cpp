// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/calibration/photo/photo_overlay.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "voxtone/io/pictures/srgb_code.h"

namespace voxtone::calibration {

namespace {

void draw(cv::Mat& picture, const Rectification& place, const Area& area, double scale, const cv::Scalar& colour) {
    std::vector<cv::Point> points;
    for (const Eigen::Vector2d& p : std::array{area.min_mm, Eigen::Vector2d(area.max_mm.x(), area.min_mm.y()),
                                               area.max_mm, Eigen::Vector2d(area.min_mm.x(), area.max_mm.y())}) {
        const Eigen::Vector2d px = place.to_px(p) * scale;
        points.emplace_back(int(std::lround(px.x() - 0.5)), int(std::lround(px.y() - 0.5)));
    }
    cv::polylines(picture, points, true, colour, 1, cv::LINE_AA);
}

}  // namespace

io::Picture8 photo_overlay(const PhotoMeasurement& m, const CheckerChart& chart, int longest_px) {
    const io::Photograph& photo = m.photograph;
    const double scale = std::min(1.0, double(longest_px) / std::max(photo.width_px, photo.height_px));
    const cv::Mat whole(int(photo.height_px), int(photo.width_px), CV_32FC3,
                        const_cast<Eigen::Vector3f*>(photo.pixels.data()));
    cv::Mat small;
    cv::resize(whole, small, {}, scale, scale, cv::INTER_AREA);
    cv::Mat picture(small.rows, small.cols, CV_8UC3);
    for (int y = 0; y < small.rows; ++y)
        for (int x = 0; x < small.cols; ++x) {
            const auto& value = small.at<cv::Vec3f>(y, x);
            const Eigen::Vector3d rho =
                m.model.reflectance(Eigen::Vector2d(x + 0.5, y + 0.5) / scale, {value[0], value[1], value[2]});
            auto& code = picture.at<cv::Vec3b>(y, x);
            for (int channel = 0; channel < 3; ++channel)
                code[channel] = io::linear_to_srgb8(float(std::clamp(rho[channel], 0.0, 1.0)));
        }
    const cv::Scalar green(0, 200, 0), red(230, 30, 30), blue(40, 110, 255), white(255, 255, 255);
    constexpr double dirty = 0.15;
    for (std::size_t s = 0; s < m.squares.size(); ++s) {
        const cv::Scalar& colour = m.squares[s].rejected > dirty ? red : green;
        draw(picture, m.view.place, m.square_areas[s], scale, colour);
        const Eigen::Vector2d at = m.squares[s].middle_px * scale;
        const std::string number = fmt::format("{}", s + 1);
        const bool dark = m.rho[s].mean() < 0.25;
        cv::putText(picture, number, cv::Point(int(at.x()) - 5 * int(number.size()), int(at.y()) + 5),
                    cv::FONT_HERSHEY_SIMPLEX, 0.5, dark ? white : cv::Scalar(0, 0, 0), 1, cv::LINE_AA);
    }
    for (const Area& area : m.frame_areas) draw(picture, m.view.place, area, scale, blue);
    for (int row = 0; row < chart.rows; ++row)
        for (int column = 0; column < chart.columns; ++column)
            draw(picture, m.checker.place, checker_area(column, row), scale, white);
    io::Picture8 result{std::uint32_t(picture.cols), std::uint32_t(picture.rows), 3, {}};
    result.codes.assign(picture.datastart, picture.dataend);
    return result;
}

}  // namespace voxtone::calibration

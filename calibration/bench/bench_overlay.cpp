// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/bench/bench_overlay.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "calibration/photo/overlay.h"

namespace voxtone::calibration {
namespace {

using Eigen::Vector2d;

constexpr OverlayColour board_colour{40, 110, 255}, region_colour{0, 190, 0}, edge_colour{255, 220, 0},
    left_out_colour{230, 30, 30}, region_of_light{255, 255, 255};

io::Picture8 picture_of(const cv::Mat& mat) {
    io::Picture8 result{std::uint32_t(mat.cols), std::uint32_t(mat.rows), 3, {}};
    result.codes.assign(mat.datastart, mat.dataend);
    return result;
}

Area area_around(const Vector2d& middle_mm, const Vector2d& half_mm) {
    return {middle_mm - half_mm, middle_mm + half_mm};
}

void draw_board(Overlay& overlay, const BoardView& board, const OverlayOptions& options) {
    constexpr int reach = 4;
    constexpr double arm = 0.08;
    const double square = options.square_mm;
    for (int row = -reach; row <= reach; ++row)
        for (int column = -reach; column <= reach; ++column)
            overlay.cross(board.place,
                          area_around({square * column, square * (row + 0.5)}, Vector2d::Constant(arm * square)),
                          board_colour);
    const Vector2d half(options.width_mm / 2, options.length_mm / 2);
    overlay.box(board.place, area_around({0, 0}, half), region_colour, 2);
    overlay.line(board.place.to_px({0, -half.y()}), board.place.to_px({0, half.y()}), edge_colour);
}

}  // namespace

io::Picture8 strip_overlay(const io::Photograph& photo, const BenchLight& light, const BoardView& board,
                           const EdgeStrip& strip, const OverlayOptions& options) {
    Overlay overlay(photo, light.model, options.longest_px);
    for (std::size_t row = 0; row < strip.y_mm.size(); ++row)
        for (std::size_t column = 0; column < strip.x_mm.size(); ++column)
            if (strip.left_out[row * strip.x_mm.size() + column])
                overlay.dot(board.place.to_px({strip.x_mm[column], strip.y_mm[row]}), left_out_colour);
    draw_board(overlay, board, options);
    return overlay.picture();
}

io::Picture8 light_overlay(const LightMap& map, const BoardView& board, const OverlayOptions& options) {
    constexpr double most = 0.05, line_every = 0.01;
    cv::Mat grey(map.height, map.width, CV_8UC1), lines(map.height, map.width, CV_8UC1, cv::Scalar(0));
    const auto deviation = [&](int x, int y) {
        return double(map.relative[std::size_t(y) * std::size_t(map.width) + std::size_t(x)]) - 1;
    };
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) {
            const double d = deviation(x, y);
            grey.at<unsigned char>(y, x) =
                static_cast<unsigned char>(std::lround(127.5 + 127.5 * std::clamp(d / most, -1.0, 1.0)));
            const auto level = [&](int i, int j) { return std::floor(deviation(i, j) / line_every + 0.5); };
            if ((x > 0 && level(x - 1, y) != level(x, y)) || (y > 0 && level(x, y - 1) != level(x, y)))
                lines.at<unsigned char>(y, x) = 255;
        }
    cv::Mat picture;
    cv::applyColorMap(grey, picture, cv::COLORMAP_VIRIDIS);
    cv::cvtColor(picture, picture, cv::COLOR_BGR2RGB);
    picture.setTo(cv::Scalar(20, 20, 20), lines);
    int line = 0;
    for (const char* text : {"light on white paper, lines every 1 %", "dark blue -5 %, yellow +5 %; white: the region"})
        cv::putText(picture, text, {8, 16 + 16 * line++}, cv::FONT_HERSHEY_SIMPLEX, 0.4, cv::Scalar(255, 255, 255), 1,
                    cv::LINE_AA);
    Overlay overlay(picture_of(picture), map.scale);
    overlay.box(board.place, area_around({0, 0}, {options.width_mm / 2, options.length_mm / 2}), region_of_light, 2);
    return overlay.picture();
}

}  // namespace voxtone::calibration

// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/calibration/bench/bench_overlay.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "voxtone/io/pictures/srgb_code.h"

namespace voxtone::calibration {
namespace {

using Eigen::Vector2d;

const cv::Scalar board_colour(40, 110, 255), region_colour(0, 190, 0), edge_colour(255, 220, 0);

class Drawing {
public:
    Drawing(cv::Mat& picture, const BoardView& board, double scale) : picture_(picture), board_(board), scale_(scale) {}

    void line(const Vector2d& from_mm, const Vector2d& to_mm, const cv::Scalar& colour, int width = 1) const {
        cv::line(picture_, at(from_mm), at(to_mm), colour, width, cv::LINE_AA, shift);
    }
    void box(const Vector2d& low, const Vector2d& high, const cv::Scalar& colour, int width) const {
        const std::array<Vector2d, 4> corners{low, Vector2d(high.x(), low.y()), high, Vector2d(low.x(), high.y())};
        for (std::size_t k = 0; k < 4; ++k) line(corners[k], corners[(k + 1) % 4], colour, width);
    }
    [[nodiscard]] cv::Point px(const Vector2d& mm) const {
        const Vector2d p = board_.place.to_px(mm) * scale_;
        return {int(std::lround(p.x() - 0.5)), int(std::lround(p.y() - 0.5))};
    }

private:
    static constexpr int shift = 4;
    [[nodiscard]] cv::Point at(const Vector2d& mm) const {
        const Vector2d p = (board_.place.to_px(mm) * scale_ - Vector2d(0.5, 0.5)) * (1 << shift);
        return {int(std::lround(p.x())), int(std::lround(p.y()))};
    }
    cv::Mat& picture_;
    const BoardView& board_;
    double scale_;
};

io::Picture8 picture_of(const cv::Mat& mat) {
    io::Picture8 result{std::uint32_t(mat.cols), std::uint32_t(mat.rows), 3, {}};
    result.codes.assign(mat.datastart, mat.dataend);
    return result;
}

void draw_board(const Drawing& drawing, const OverlayOptions& options) {
    constexpr int reach = 4;
    const double square = options.square_mm;
    for (int row = -reach; row <= reach; ++row)
        for (int column = -reach; column <= reach; ++column) {
            const Vector2d node(square * column, square * (row + 0.5)), x(0.08 * square, 0), y(0, 0.08 * square);
            drawing.line(node - x, node + x, board_colour);
            drawing.line(node - y, node + y, board_colour);
        }
    const Vector2d half(options.width_mm / 2, options.length_mm / 2);
    drawing.box(-half, half, region_colour, 2);
    drawing.line({0, -half.y()}, {0, half.y()}, edge_colour);
}

}  // namespace

io::Picture8 strip_overlay(const io::Photograph& photo, const BenchLight& light, const BoardView& board,
                           const EdgeStrip& strip, const OverlayOptions& options) {
    const double scale = std::min(1.0, double(options.longest_px) / std::max(photo.width_px, photo.height_px));
    const cv::Mat whole(int(photo.height_px), int(photo.width_px), CV_32FC3,
                        const_cast<Eigen::Vector3f*>(photo.pixels.data()));
    cv::Mat small;
    cv::resize(whole, small, {}, scale, scale, cv::INTER_AREA);
    cv::Mat picture(small.rows, small.cols, CV_8UC3);
    for (int y = 0; y < small.rows; ++y)
        for (int x = 0; x < small.cols; ++x) {
            const auto& value = small.at<cv::Vec3f>(y, x);
            const Eigen::Vector3d rho =
                light.model.reflectance(Vector2d(x + 0.5, y + 0.5) / scale, {value[0], value[1], value[2]});
            for (int channel = 0; channel < 3; ++channel)
                picture.at<cv::Vec3b>(y, x)[channel] = io::linear_to_srgb8(float(std::clamp(rho[channel], 0.0, 1.0)));
        }
    const Drawing drawing(picture, board, scale);
    for (std::size_t row = 0; row < strip.y_mm.size(); ++row)
        for (std::size_t column = 0; column < strip.x_mm.size(); ++column)
            if (strip.left_out[row * strip.x_mm.size() + column]) {
                const cv::Point p = drawing.px({strip.x_mm[column], strip.y_mm[row]});
                if (p.x >= 0 && p.y >= 0 && p.x < picture.cols && p.y < picture.rows)
                    picture.at<cv::Vec3b>(p) = cv::Vec3b(230, 30, 30);
            }
    draw_board(drawing, options);
    return picture_of(picture);
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
    const Drawing drawing(picture, board, map.scale);
    const Vector2d half(options.width_mm / 2, options.length_mm / 2);
    drawing.box(-half, half, cv::Scalar(255, 255, 255), 2);
    int line = 0;
    for (const char* text : {"light on white paper, lines every 1 %", "dark blue -5 %, yellow +5 %; white: the region"})
        cv::putText(picture, text, {8, 16 + 16 * line++}, cv::FONT_HERSHEY_SIMPLEX, 0.4, cv::Scalar(255, 255, 255), 1,
                    cv::LINE_AA);
    return picture_of(picture);
}

}  // namespace voxtone::calibration

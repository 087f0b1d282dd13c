// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/compare/print_place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "base/parallel.h"

namespace voxtone::calibration {

namespace {

constexpr double least_correlation = 0.5;  // below it is another print
constexpr double least_found = 0.7;        // in its place; right prints have 0.8 to 0.99
constexpr double least_pattern = 0.03;     // standard deviation of the prediction's logarithms: less shows no place
constexpr double most_aspect_off = 0.2;    // relative: a tilt of 30 degrees shortens a side by 13 %
constexpr double dark = 0.03;              // of white: added before logarithms, so that noise in blacks does not count
constexpr double most_lost = 0.05;         // of correlation, on the way to a better one
constexpr int border_cells = 3;            // beside the print's edge: the ground is seen there

/// The corners of a print of this size, clockwise with y down.
PrintCorners own_corners(const Eigen::Vector2d& size) {
    return {Eigen::Vector2d(0, 0), Eigen::Vector2d(size.x(), 0), size, Eigen::Vector2d(0, size.y())};
}

cv::Mat picture_of(const std::vector<Eigen::Vector3f>& rgb, int columns, int rows) {
    cv::Mat picture(rows, columns, CV_32FC3);
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
            const Eigen::Vector3f& c = rgb[std::size_t(y) * std::size_t(columns) + std::size_t(x)];
            picture.at<cv::Vec3f>(y, x) = {c[0], c[1], c[2]};
        }
    return picture;
}

/// The brightest twentieth of each channel becomes 1, so that `dark` means the same in all.
void scale_to_white(cv::Mat& picture) {
    std::array<std::vector<float>, 3> values;
    for (int y = 0; y < picture.rows; ++y)
        for (int x = 0; x < picture.cols; ++x)
            for (int c = 0; c < 3; ++c) values[std::size_t(c)].push_back(picture.at<cv::Vec3f>(y, x)[c]);
    cv::Scalar gain;
    for (std::size_t c = 0; c < 3; ++c) {
        const auto at = values[c].begin() + std::ptrdiff_t(double(values[c].size() - 1) * 0.95);
        std::nth_element(values[c].begin(), at, values[c].end());
        gain[int(c)] = 1 / std::max(double(*at), 1e-6);
    }
    cv::multiply(picture, gain, picture);
}

/// Logarithms, smoothed by `sigma` cells, less what lies around.
cv::Mat features(cv::Mat picture, double sigma) {
    scale_to_white(picture);
    for (int y = 0; y < picture.rows; ++y)
        for (int x = 0; x < picture.cols; ++x)
            for (int c = 0; c < 3; ++c) {
                float& v = picture.at<cv::Vec3f>(y, x)[c];
                v = std::log(std::max(v, 0.0f) + float(dark));
            }
    cv::Mat near, far;
    cv::GaussianBlur(picture, near, {}, sigma, sigma, cv::BORDER_REPLICATE);
    const double wide = 6 * sigma + 6;
    cv::GaussianBlur(picture, far, {}, wide, wide, cv::BORDER_REPLICATE);
    return near - far;
}

/// Of two pictures of the same size, about their means, over all channels.
double correlation_of(const cv::Mat& a, const cv::Mat& b) {
    double ab = 0, aa = 0, bb = 0;
    const cv::Scalar mean_a = cv::mean(a), mean_b = cv::mean(b);
    for (int y = 0; y < a.rows; ++y)
        for (int x = 0; x < a.cols; ++x)
            for (int c = 0; c < 3; ++c) {
                const double u = a.at<cv::Vec3f>(y, x)[c] - mean_a[c], v = b.at<cv::Vec3f>(y, x)[c] - mean_b[c];
                ab += u * v, aa += u * u, bb += v * v;
            }
    return ab / std::sqrt(std::max(aa * bb, 1e-30));
}

/// The prediction in at most this many cells a side.
cv::Mat coarse_of(const PredictedPrint& print, int most) {
    const double by = std::max(1.0, double(std::max(print.columns, print.rows)) / most);
    const cv::Size size(std::max(4, int(std::lround(print.columns / by))),
                        std::max(4, int(std::lround(print.rows / by))));
    cv::Mat coarse;
    cv::resize(picture_of(print.rgb, print.columns, print.rows), coarse, size, 0, 0, cv::INTER_AREA);
    return coarse;
}

struct Pose {
    Rectification place;
    double correlation = -2;
};

/// The best of the eight ways in which each of these may be the print: as it is, and mirrored.
std::array<Pose, 2> best_poses(const io::Photograph& photo, const std::vector<PrintCorners>& may_be,
                               const PredictedPrint& print) {
    constexpr int coarse_cells = 64;
    const cv::Mat coarse = coarse_of(print, coarse_cells);
    const cv::Mat expected = features(coarse.clone(), 1);
    cv::Scalar mean, deviation;
    cv::meanStdDev(expected, mean, deviation);
    if (std::max({deviation[0], deviation[1], deviation[2]}) < least_pattern)
        throw InputError(
            fmt::format("{}: the print is of one colour, so nothing tells how it lies in a photograph; "
                        "compare prints that show a pattern",
                        print.name));
    const PrintCorners own = own_corners(print.size());
    const Eigen::Vector3d no_clip = Eigen::Vector3d::Constant(INFINITY);
    const Eigen::Vector2d grid(coarse.cols, coarse.rows);
    std::array<Pose, 2> best;
    for (const PrintCorners& px : may_be)
        for (std::size_t turn = 0; turn < 4; ++turn)
            for (const bool mirrored : {false, true}) {
                PrintCorners order;
                for (std::size_t c = 0; c < 4; ++c) order[c] = px[(mirrored ? 4 + turn - c : c + turn) % 4];
                const PrintPlace place(Rectification::fit(own_corners(grid), order), grid);
                const CellSamples seen = sample_cells(photo, place, coarse.cols, coarse.rows, no_clip);
                const double correlation =
                    correlation_of(features(picture_of(seen.value, coarse.cols, coarse.rows), 1), expected);
                if (correlation > best[mirrored].correlation)
                    best[mirrored] = {Rectification::fit(own, order), correlation};
            }
    return best;
}

/// Length by width of what the corners enclose, as far as sides tell it.
double aspect_of(const Rectification& place, const Eigen::Vector2d& size) {
    const PrintCorners own = own_corners(size);
    std::array<double, 4> side{};
    for (std::size_t c = 0; c < 4; ++c) side[c] = (place.to_px(own[(c + 1) % 4]) - place.to_px(own[c])).norm();
    return (side[0] + side[2]) / (side[1] + side[3]);
}

void check_pose(const io::Photograph& photo, const PredictedPrint& print, const std::array<Pose, 2>& poses) {
    const auto& [upright, mirrored] = poses;
    if (mirrored.correlation > upright.correlation && mirrored.correlation >= least_correlation)
        throw InputError(fmt::format(
            "{}: the print is mirrored against {}: left and right are exchanged (along x; or top and bottom, along y, "
            "if it lies turned by 180 degrees), so that set-up mirrors; print `voxtone target marker` and set what its "
            "page says in the printer's profile, or give the photograph as it was taken",
            photo.name, print.name));
    const double seen = aspect_of(upright.place, print.size()),
                 own = print.size().x() * print.cell_mm.x() / (print.size().y() * print.cell_mm.y());
    const double off = seen / own;
    const bool stretched = off > 1 + most_aspect_off || off < 1 / (1 + most_aspect_off);
    if (upright.correlation < least_correlation)
        throw InputError(fmt::format(
            "{}: this is no photograph of {}: what is seen correlates with the prediction by {:.2f} at most, turned "
            "and "
            "mirrored too, and {:.1f} is the least{}; give a photograph of this print, or its corners by hand with "
            "--corners",
            photo.name, print.name, std::max(upright.correlation, mirrored.correlation), least_correlation,
            stretched ? fmt::format(" (and its sides are as {:.2f} to 1 in place of {:.2f})", seen, own) : ""));
    if (stretched)
        throw InputError(fmt::format(
            "{}: the print's sides are as {:.2f} to 1, and those of {} as {:.2f} to 1: it was printed stretched, or "
            "photographed too far from the side; check the printer's resolution, and photograph it from above",
            photo.name, seen, print.name, own));
}

/// One step of Gauss-Newton. Gives back how far it moved the print, root mean square, in cells.
double move(PrintPlace& place, const cv::Mat& seen, const cv::Mat& expected, int terms) {
    cv::Mat along_x, along_y;
    const cv::Mat both = 0.5 * (seen + expected);
    cv::Sobel(both, along_x, CV_32F, 1, 0, 3, 1.0 / 8, 0, cv::BORDER_REPLICATE);
    cv::Sobel(both, along_y, CV_32F, 0, 1, 3, 1.0 / 8, 0, cv::BORDER_REPLICATE);
    double squares = 0;
    std::size_t count = 0;
    const auto inside = [&](auto&& visit) {
        for (int y = border_cells; y < seen.rows - border_cells; ++y)
            for (int x = border_cells; x < seen.cols - border_cells; ++x)
                for (int c = 0; c < 3; ++c)
                    visit(x, y, c, expected.at<cv::Vec3f>(y, x)[c] - seen.at<cv::Vec3f>(y, x)[c]);
    };
    inside([&](int, int, int, float off) { squares += double(off) * off, ++count; });
    if (count == 0) return 0;
    const double scale = squares / double(count);
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(2 * terms, 2 * terms);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(2 * terms), row(2 * terms);
    inside([&](int x, int y, int c, float off) {
        const double weight = std::pow(scale / (scale + double(off) * off), 2);
        const Eigen::VectorXd basis = place.basis({x + 0.5, y + 0.5}).head(terms);
        row << along_x.at<cv::Vec3f>(y, x)[c] * basis, along_y.at<cv::Vec3f>(y, x)[c] * basis;
        normal.selfadjointView<Eigen::Lower>().rankUpdate(row, weight);
        right += weight * off * row;
    });
    // What no pattern tells stays as it is.
    normal.diagonal().array() += 1e-4 * normal.trace() / (2 * terms);
    const Eigen::VectorXd step = normal.selfadjointView<Eigen::Lower>().ldlt().solve(right);
    PrintPlace::Shift shift = PrintPlace::Shift::Zero();
    shift.topRows(terms) << step.head(terms), step.tail(terms);
    place.add(shift);
    double moved = 0;
    for (const Eigen::Vector2d& corner : own_corners(place.size()))
        moved += (shift.transpose() * place.basis(corner)).squaredNorm() / 4;
    return std::sqrt(moved);
}

}  // namespace

Eigen::Matrix<double, PrintPlace::terms, 1> PrintPlace::basis(const Eigen::Vector2d& cell) const {
    const double u = 2 * cell.x() / size_.x() - 1, v = 2 * cell.y() / size_.y() - 1;
    return {1, u, v, u * u, u * v, v * v, u * u * u, u * u * v, u * v * v, v * v * v};
}

Eigen::Vector3f sample_at(const io::Photograph& photo, const Eigen::Vector2d& px) {
    const double x = std::clamp(px.x() - 0.5, 0.0, photo.width_px - 1.0),
                 y = std::clamp(px.y() - 0.5, 0.0, photo.height_px - 1.0);
    const auto x0 = std::uint32_t(x), y0 = std::uint32_t(y);
    const std::uint32_t x1 = std::min(x0 + 1, photo.width_px - 1), y1 = std::min(y0 + 1, photo.height_px - 1);
    const auto u = float(x - x0), v = float(y - y0);
    return (1 - v) * ((1 - u) * photo.pixels[photo.index(x0, y0)] + u * photo.pixels[photo.index(x1, y0)]) +
           v * ((1 - u) * photo.pixels[photo.index(x0, y1)] + u * photo.pixels[photo.index(x1, y1)]);
}

CellSamples sample_cells(const io::Photograph& photo, const PrintPlace& place, int columns, int rows,
                         const Eigen::Vector3d& clip) {
    const int along = std::clamp(int(std::ceil(place.px_per_cell())), 1, 32);
    CellSamples samples;
    samples.value.resize(std::size_t(columns) * std::size_t(rows));
    samples.good.resize(samples.value.size());
    const Eigen::Vector3f level = clip.cast<float>();
    parallel_for(0, std::size_t(rows), 4, [&](std::size_t row) {
        for (int column = 0; column < columns; ++column) {
            Eigen::Vector3f sum = Eigen::Vector3f::Zero();
            bool good = true;
            for (int s = 0; s < along * along; ++s) {
                const Eigen::Vector2d px =
                    place.to_px({column + (s % along + 0.5) / along, double(row) + (s / along + 0.5) / along});
                good &= px.x() >= 0 && px.y() >= 0 && px.x() <= photo.width_px && px.y() <= photo.height_px;
                const Eigen::Vector3f value = sample_at(photo, px);
                good &= (value.array() < level.array()).all();
                sum += value;
            }
            const std::size_t cell = row * std::size_t(columns) + std::size_t(column);
            samples.value[cell] = sum / float(along * along);
            samples.good[cell] = good;
        }
    });
    return samples;
}

FoundPrint place_print(const io::Photograph& photo, const std::vector<PrintCorners>& may_be,
                       const PredictedPrint& print) {
    const std::array<Pose, 2> poses = best_poses(photo, may_be, print);
    check_pose(photo, print, poses);
    FoundPrint found{PrintPlace(poses[0].place, print.size()), 0, 0};
    if (found.place.px_per_cell() < 1)
        throw InputError(fmt::format(
            "{}: the photograph is too small: a cell of the prediction ({:.3f} mm) is {:.2f} pixels wide, and at least "
            "one is needed; come nearer, or compare larger cells (--cell {:.2f}mm)",
            photo.name, print.cell_mm.x(), found.place.px_per_cell(),
            1.1 * print.cell_mm.x() / found.place.px_per_cell()));
    const cv::Mat predicted = picture_of(print.rgb, print.columns, print.rows);
    const Eigen::Vector3d no_clip = Eigen::Vector3d::Constant(INFINITY);
    struct Level {
        double sigma;  // cells
        int terms;     // 3: a plane, 6: and squares, 10: all
    };
    for (const Level level : {Level{6, 3}, Level{3, 6}, Level{1.5, 10}, Level{0.8, 10}}) {
        const cv::Mat expected = features(predicted.clone(), level.sigma);
        constexpr int most_steps = 8;
        // Of all steps what correlates best is kept: little contrast, or much noise, can lead them astray.
        PrintPlace place = found.place;
        found.correlation = -1;
        bool ended = false;
        for (int step = 0; step <= most_steps && !ended; ++step) {
            const CellSamples seen = sample_cells(photo, place, print.columns, print.rows, no_clip);
            const cv::Mat shown = features(picture_of(seen.value, print.columns, print.rows), level.sigma);
            const double correlation = correlation_of(shown, expected);
            if (correlation > found.correlation) found.correlation = correlation, found.place = place;
            if (correlation < found.correlation - most_lost) break;
            ended = move(place, shown, expected, level.terms) < 0.01 * level.sigma;
        }
    }
    if (found.correlation < least_found)
        throw InputError(fmt::format(
            "{}: what lies there is like {} in parts only: it correlates by {:.2f}, and {:.1f} is the least at which "
            "differences tell of the print and not of another one or of a wrong place; give the photograph of this "
            "print, whole and sharp, or its corners by hand with --corners",
            photo.name, print.name, found.correlation, least_found));
    const Eigen::Vector2d middle = print.size() / 2, right(print.size().x(), middle.y());
    const Eigen::Vector2d way = found.place.to_px(right) - found.place.to_px(middle);
    const double quarters = std::atan2(way.y(), way.x()) / (std::numbers::pi / 2);
    found.turned_deg = 90 * ((int(std::lround(quarters)) + 4) % 4);
    return found;
}

}  // namespace voxtone::calibration

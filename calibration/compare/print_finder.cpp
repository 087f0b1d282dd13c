// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/compare/print_finder.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "calibration/photo/finder_picture.h"

namespace voxtone::calibration {

namespace {

constexpr double finder_px = 1000;      // the longer side of what is looked at
constexpr double least_share = 0.02;    // of the picture, that a print covers
constexpr double least_difference = 8;  // of 255, between print and ground
constexpr double border_share = 0.03;   // of the longer side: the band that is ground

const char* by_hand() {
    return "lay it on ground of one colour that it has not (dark grey card), all of it in the picture and nothing else "
           "beside it, or give its corners by hand with --corners X,Y,X,Y,X,Y,X,Y";
}

/// 0 to 255: how far each pixel lies from a plane of colour through the border; where `shadow` is given, 1 there where
/// it has the ground's colour and is darker.
cv::Mat difference_from_ground(const cv::Mat& bgr, cv::Mat* shadow = nullptr) {
    const int band = std::max(2, int(border_share * std::max(bgr.cols, bgr.rows)));
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero(), right = Eigen::Matrix3d::Zero();
    std::vector<Eigen::Vector3d> places, colours;
    for (int y = 0; y < bgr.rows; ++y)
        for (int x = 0; x < bgr.cols; ++x) {
            if (x >= band && y >= band && x < bgr.cols - band && y < bgr.rows - band) continue;
            const auto& p = bgr.at<cv::Vec3b>(y, x);
            places.emplace_back(1, double(x) / bgr.cols, double(y) / bgr.rows);
            colours.emplace_back(p[0], p[1], p[2]);
        }
    std::vector<double> weight(places.size(), 1);
    Eigen::Matrix3d plane = Eigen::Matrix3d::Zero();
    constexpr int rounds = 5;
    for (int round = 0; round < rounds; ++round) {
        normal.setZero();
        right.setZero();
        for (std::size_t i = 0; i < places.size(); ++i) {
            normal += weight[i] * places[i] * places[i].transpose();
            right += weight[i] * places[i] * colours[i].transpose();
        }
        plane = (normal + 1e-9 * Eigen::Matrix3d::Identity()).inverse() * right;
        for (std::size_t i = 0; i < places.size(); ++i) {
            constexpr double scale = 6;  // of 255: what is farther is not ground
            weight[i] = 1 / (1 + (colours[i] - plane.transpose() * places[i]).squaredNorm() / (scale * scale));
        }
    }
    cv::Mat difference(bgr.rows, bgr.cols, CV_8UC1);
    for (int y = 0; y < bgr.rows; ++y)
        for (int x = 0; x < bgr.cols; ++x) {
            const auto& p = bgr.at<cv::Vec3b>(y, x);
            const Eigen::Vector3d ground =
                plane.transpose() * Eigen::Vector3d(1, double(x) / bgr.cols, double(y) / bgr.rows);
            const double off = (Eigen::Vector3d(p[0], p[1], p[2]) - ground).cwiseAbs().maxCoeff();
            difference.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(off);
            if (!shadow) continue;
            constexpr double alike = 0.15;
            const Eigen::Vector3d share = Eigen::Vector3d(p[0], p[1], p[2]).cwiseQuotient(ground.cwiseMax(1.0));
            shadow->at<std::uint8_t>(y, x) = share.maxCoeff() < 1 && share.maxCoeff() - share.minCoeff() < alike;
        }
    return difference;
}

/// Of things of some size, the largest first.
std::vector<std::vector<cv::Point>> contours_of(const cv::Mat& mask) {
    std::vector<std::vector<cv::Point>> contours;
    cv::findContours(mask, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
    std::erase_if(contours, [&](const auto& c) {
        return c.size() < 8 || cv::contourArea(c) < least_share * mask.cols * mask.rows;
    });
    std::ranges::sort(contours, [](const auto& a, const auto& b) { return cv::contourArea(a) > cv::contourArea(b); });
    return contours;
}

/// The hull's four corners, or nothing where it has not four.
std::optional<PrintCorners> four_corners(const std::vector<cv::Point>& contour) {
    std::vector<cv::Point> hull, corners;
    cv::convexHull(contour, hull);
    const double around = cv::arcLength(hull, true);
    for (double share = 0.01; share < 0.08 && corners.size() != 4; share *= 1.2) {
        cv::approxPolyDP(hull, corners, share * around, true);
        if (corners.size() < 4) return std::nullopt;
    }
    if (corners.size() != 4) return std::nullopt;
    PrintCorners found;
    for (std::size_t c = 0; c < 4; ++c) found[c] = {corners[c].x + 0.5, corners[c].y + 0.5};
    return found;
}

/// Crossings of lines through the contour's points along each side.
PrintCorners refined(const PrintCorners& rough, const std::vector<cv::Point>& contour) {
    std::array<Eigen::Vector3d, 4> lines;
    for (std::size_t side = 0; side < 4; ++side) {
        const Eigen::Vector2d from = rough[side], along = rough[(side + 1) % 4] - from;
        std::vector<cv::Point2f> points;
        for (const cv::Point& p : contour) {
            const Eigen::Vector2d off = Eigen::Vector2d(p.x + 0.5, p.y + 0.5) - from;
            const double t = off.dot(along) / along.squaredNorm();
            const double beside = std::abs(off.x() * along.y() - off.y() * along.x()) / along.norm();
            if (t > 0.1 && t < 0.9 && beside < 0.03 * along.norm() + 2)
                points.emplace_back(float(p.x + 0.5), float(p.y + 0.5));
        }
        if (points.size() < 8) return rough;
        cv::Vec4f line;
        cv::fitLine(points, line, cv::DIST_HUBER, 0, 0.01, 0.001);
        lines[side] =
            Eigen::Vector3d(line[2], line[3], 1).cross(Eigen::Vector3d(line[2] + line[0], line[3] + line[1], 1));
    }
    PrintCorners corners;
    for (std::size_t c = 0; c < 4; ++c) {
        const Eigen::Vector3d crossing = lines[(c + 3) % 4].cross(lines[c]);
        corners[c] = crossing.hnormalized();
        if (!corners[c].allFinite() || (corners[c] - rough[c]).norm() > 0.1 * (rough[0] - rough[2]).norm())
            return rough;
    }
    return corners;
}

/// Twice the area of the figure, above 0 where it runs clockwise with y down.
double twice_area(const PrintCorners& c) {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) sum += c[i].x() * c[(i + 1) % 4].y() - c[i].y() * c[(i + 1) % 4].x();
    return sum;
}

/// In a picture of this size, `scale` times as large as the photograph.
struct Things {
    int columns = 0, rows = 0;
    double scale = 1;
    std::vector<std::vector<cv::Point>> contours;
    cv::Mat shadow;  ///< 1 where it may be one
};

Things things_on_ground(const io::Photograph& photo) {
    std::vector<std::uint8_t> codes = finder_bgr(photo);
    const cv::Mat whole(int(photo.height_px), int(photo.width_px), CV_8UC3, codes.data());
    const double scale = std::min(1.0, finder_px / std::max(whole.cols, whole.rows));
    cv::Mat small = whole.clone(), mask;
    if (scale < 1) cv::resize(whole, small, {}, scale, scale, cv::INTER_AREA);
    cv::Mat shadow = cv::Mat::zeros(small.size(), CV_8UC1);
    const cv::Mat difference = difference_from_ground(small, &shadow);
    const double level = cv::threshold(difference, mask, 0, 255, cv::THRESH_BINARY | cv::THRESH_OTSU);
    // Otsu's level halves the way to what is bright; a print's dim parts lie nearer to the ground.
    cv::threshold(difference, mask, std::max(least_difference, 0.35 * level), 255, cv::THRESH_BINARY);
    const int reach = std::max(3, small.cols / 150) | 1;
    const cv::Mat brush = cv::getStructuringElement(cv::MORPH_RECT, {reach, reach});
    cv::morphologyEx(mask, mask, cv::MORPH_OPEN, cv::getStructuringElement(cv::MORPH_RECT, {3, 3}));
    cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, brush);
    return {small.cols, small.rows, scale, contours_of(mask), shadow};
}

bool is_cut_off(const std::vector<cv::Point>& contour, const Things& things) {
    const cv::Rect box = cv::boundingRect(contour);
    return box.x <= 1 || box.y <= 1 || box.x + box.width >= things.columns - 1 || box.y + box.height >= things.rows - 1;
}

}  // namespace

PrintCorners checked_corners(const io::Photograph& photo, const PrintCorners& corners) {
    PrintCorners c = corners;
    if (twice_area(c) < 0) std::swap(c[1], c[3]);
    bool convex = true, inside = true;
    for (std::size_t i = 0; i < 4; ++i) {
        const Eigen::Vector2d a = c[(i + 1) % 4] - c[i], b = c[(i + 2) % 4] - c[(i + 1) % 4];
        convex &= a.x() * b.y() - a.y() * b.x() > 0;
        inside &= c[i].x() > -1 && c[i].y() > -1 && c[i].x() < photo.width_px + 1 && c[i].y() < photo.height_px + 1;
    }
    if (!inside)
        throw InputError(fmt::format("--corners: a corner lies outside of {}, which has {} x {} pixels", photo.name,
                                     photo.width_px, photo.height_px));
    if (!convex)
        throw InputError(
            "--corners: the four corners are to be given one after the other round the print, as X,Y in pixels of the "
            "photograph; these cross over or lie in a line");
    return c;
}

std::vector<PrintCorners> find_prints(const io::Photograph& photo) {
    const Things things = things_on_ground(photo);
    if (things.contours.empty())
        throw InputError(
            fmt::format("{}: no print is found: nothing of size differs from the ground; {}", photo.name, by_hand()));
    std::vector<PrintCorners> found;
    bool cut_off = false;
    for (const std::vector<cv::Point>& contour : things.contours) {
        if (is_cut_off(contour, things)) {
            cut_off = true;
            continue;
        }
        const std::optional<PrintCorners> rough = four_corners(contour);
        if (!rough) continue;
        PrintCorners corners = refined(*rough, contour);
        for (Eigen::Vector2d& corner : corners) corner /= things.scale;
        found.push_back(checked_corners(photo, corners));
    }
    if (found.empty() && cut_off)
        throw InputError(fmt::format(
            "{}: what differs from the ground reaches the edge of the picture, so the print is cut off or the ground "
            "is not of one colour; {}",
            photo.name, by_hand()));
    if (found.empty())
        throw InputError(
            fmt::format("{}: what differs from the ground has not four corners; {}", photo.name, by_hand()));
    return found;
}

/// A shadow may reach the picture's edge, the body not.
Silhouette find_silhouette(const io::Photograph& photo) {
    constexpr const char* mend =
        "stand it before ground of one colour that it has not (dark grey card that is bent up behind it), all of it in "
        "the picture and nothing else beside it";
    const Things things = things_on_ground(photo);
    if (things.contours.empty())
        throw InputError(
            fmt::format("{}: no body is found: nothing of size differs from the ground; {}", photo.name, mend));
    cv::Mat part = cv::Mat::zeros(things.rows, things.columns, CV_8UC1);
    cv::drawContours(part, things.contours, 0, cv::Scalar(Silhouette::thing_or_its_shadow), cv::FILLED);
    cv::Mat sure = part & (things.shadow == 0);
    cv::morphologyEx(sure, sure, cv::MORPH_OPEN, cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5}));
    std::vector<std::vector<cv::Point>> contours;
    cv::findContours(sure, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
    if (std::ranges::any_of(contours, [&](const auto& contour) { return is_cut_off(contour, things); }))
        throw InputError(fmt::format(
            "{}: what differs from the ground reaches the edge of the picture, so the body is cut off or the ground "
            "is not of one colour; {}",
            photo.name, mend));
    cv::drawContours(part, contours, -1, cv::Scalar(Silhouette::thing), cv::FILLED);
    return {things.columns, things.rows, 1 / things.scale, {part.begin<std::uint8_t>(), part.end<std::uint8_t>()}};
}

}  // namespace voxtone::calibration

// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/calibration/fiducials.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>

#include "voxtone/base/error.h"
#include "voxtone/calibration/finder_picture.h"
#include "voxtone/calibration/marker_pattern.h"

namespace voxtone::calibration {

namespace {

using Eigen::Vector2d;
using Corners = std::array<Vector2d, 4>;  // upper left, upper right, lower right, lower left

constexpr std::size_t enough = 3;
constexpr double finder_px = 2400;       // longest side of the picture in which markers are looked for
constexpr double worst_residual = 0.08;  // mm: beyond this the markers do not lie as described

Corners corners_of(const Area& area) {
    return {Vector2d(area.min_mm.x(), area.max_mm.y()), area.max_mm, Vector2d(area.max_mm.x(), area.min_mm.y()), area.min_mm};
}

/// Markers in an 8-bit grey picture by number; corners in pixels.
std::map<int, Corners> find_markers(const cv::Mat& grey, bool inverted) {
    const double scale = std::min(1.0, finder_px / std::max(grey.cols, grey.rows));
    cv::Mat small = grey;
    if (scale < 1) cv::resize(grey, small, {}, scale, scale, cv::INTER_AREA);
    const auto parameters = cv::aruco::DetectorParameters::create();
    parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
    parameters->adaptiveThreshWinSizeMax = 63;
    parameters->detectInvertedMarker = inverted;
    std::vector<std::vector<cv::Point2f>> corners;
    std::vector<int> ids;
    cv::aruco::detectMarkers(small, cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_1000), corners, ids, parameters);
    std::map<int, Corners> found;
    for (std::size_t m = 0; m < ids.size(); ++m) {
        Corners& at = found[ids[m]];
        // OpenCV has the middle of the first pixel at 0.
        for (std::size_t c = 0; c < 4; ++c) at[c] = Vector2d(corners[m][c].x + 0.5, corners[m][c].y + 0.5) / scale;
    }
    return found;
}

std::map<int, Corners> known_markers(const std::map<int, Corners>& found, const Target& target) {
    std::map<int, Corners> known;
    for (const TargetMarker& marker : target.markers)
        if (const auto at = found.find(marker.id); at != found.end()) known.insert(*at);
    return known;
}

[[noreturn]] void fail_to_find(const cv::Mat& grey, const std::map<int, Corners>& found, const Target& target, const std::string& name) {
    std::vector<int> wanted;
    for (const TargetMarker& marker : target.markers) wanted.push_back(marker.id);
    cv::Mat mirrored;
    cv::flip(grey, mirrored, 1);
    if (known_markers(find_markers(mirrored, false), target).size() >= 2)
        throw InputError(fmt::format("{}: the target is mirrored. Either the picture was mirrored, or the printer mirrors what it prints: then set flip_x in its profile "
                                     "and print the target again, for all other prints are mirrored as well", name));
    if (known_markers(find_markers(grey, true), target).size() >= 2)
        throw InputError(fmt::format("{}: the markers are light on dark: the resins {} and {} were exchanged when they were assigned to the bitmaps' colours, or the picture "
                                     "is a negative. Every square would be taken for another one; print again with the resins as the assignment sheet says", name, target.light, target.dark));
    if (found.size() >= 2 && known_markers(found, target).empty()) {
        std::vector<int> there;
        for (const auto& [id, corners] : found) there.push_back(id);
        throw InputError(fmt::format("{}: this is another target: its markers are {}, those of the description are {}. Give the target.json that lay beside the layers which "
                                     "were printed", name, fmt::join(there, ", "), fmt::join(wanted, ", ")));
    }
    throw InputError(fmt::format("{}: no target found: {} of the markers {} are seen, {} are needed. The whole target must be in the picture, sharp, with its light frame "
                                 "(at least 5 pixels per marker cell, no glare on the markers); or give the corners of the slab by hand with --corners",
                                 name, known_markers(found, target).size(), fmt::join(wanted, ", "), enough));
}

/// The nearest corners of the picture, to a fraction of a pixel.
void refine(const cv::Mat& grey, std::vector<Vector2d>& px, double cell_px) {
    std::vector<cv::Point2f> points;
    for (const Vector2d& p : px) points.emplace_back(float(p.x() - 0.5), float(p.y() - 0.5));
    const int reach = std::clamp(int(0.4 * cell_px), 2, 40);
    cv::cornerSubPix(grey, points, {reach, reach}, {-1, -1}, {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 50, 0.005});
    for (std::size_t i = 0; i < px.size(); ++i) {
        const Vector2d refined(points[i].x + 0.5, points[i].y + 0.5);
        if ((refined - px[i]).norm() < reach) px[i] = refined;
    }
}

float bilinear(const cv::Mat& grey, const Vector2d& p) {
    const double x = std::clamp(p.x() - 0.5, 0.0, grey.cols - 1.001), y = std::clamp(p.y() - 0.5, 0.0, grey.rows - 1.001);
    const int i = int(x), j = int(y);
    const float u = float(x - i), v = float(y - j);
    const auto at = [&](int row, int column) { return float(grey.at<unsigned char>(row, column)); };
    return (1 - v) * ((1 - u) * at(j, i) + u * at(j, i + 1)) + v * ((1 - u) * at(j + 1, i) + u * at(j + 1, i + 1));
}

/// How well the cells of all markers agree with the picture: 1 as they should be, -1 exchanged, about 0 elsewhere.
double agreement(const cv::Mat& grey, const Target& target, const Rectification& place) {
    double worst_of_best = 1;
    std::vector<double> each;
    for (const TargetMarker& marker : target.markers) {
        const std::vector<bool> dark = marker_pattern(marker.id);
        const double cell = marker.area.size().x() / marker_cells;
        double sum = 0, sum_value = 0, sum_light = 0, value2 = 0, light2 = 0;
        for (int k = 0; k < marker_cells * marker_cells; ++k) {
            const Vector2d middle(marker.area.min_mm.x() + (k % marker_cells + 0.5) * cell, marker.area.max_mm.y() - (k / marker_cells + 0.5) * cell);
            const double value = bilinear(grey, place.to_px(middle)), light = dark[std::size_t(k)] ? 0 : 1;
            sum += value * light;
            sum_value += value;
            sum_light += light;
            value2 += value * value;
            light2 += light * light;
        }
        const double n = marker_cells * marker_cells;
        const double spread = (value2 - sum_value * sum_value / n) * (light2 - sum_light * sum_light / n);
        each.push_back(spread > 0 ? (sum - sum_value * sum_light / n) / std::sqrt(spread) : 0);
    }
    std::sort(each.begin(), each.end(), [](double a, double b) { return std::abs(a) > std::abs(b); });
    worst_of_best = each[enough - 1];
    return worst_of_best;
}

/// Says which other way the corners would fit.
void check_corners(const cv::Mat& grey, const Target& target, const Corners& given, const std::string& name) {
    constexpr double good = 0.7;
    const Corners own = corners_of({Vector2d::Zero(), target.size_mm});
    const auto place = [&](int turn, bool mirrored) {
        Corners px;
        for (std::size_t c = 0; c < 4; ++c) px[c] = given[(mirrored ? 4 + std::size_t(turn) - c : c + std::size_t(turn)) % 4];
        return Rectification::fit(own, px);
    };
    const double as_given = agreement(grey, target, place(0, false));
    if (as_given > good) return;
    for (int turn = 0; turn < 4; ++turn)
        for (const bool mirrored : {false, true}) {
            const double fits = agreement(grey, target, place(turn, mirrored));
            if (fits < -good)
                throw InputError(fmt::format("{}: at the given corners the markers are light on dark: the resins {} and {} are exchanged", name, target.light, target.dark));
            if (fits > good)
                throw InputError(mirrored ? fmt::format("{}: at the given corners the target is mirrored, or the corners are given anticlockwise; they must be upper left, upper "
                                                        "right, lower right, lower left", name)
                                          : fmt::format("{}: the given corners are those of the target turned by {} degrees; the first must be the upper left one, beside marker {}", name,
                                                        90 * turn, target.markers[0].id));
        }
    throw InputError(fmt::format("{}: between the given corners there are not the markers of the description ({} to {}); are these the corners of the slab, in the order upper "
                                 "left, upper right, lower right, lower left, and is it this target?", name, target.markers[0].id, target.markers[3].id));
}

/// Standard deviation of the blur, mm: the spread of the slope across the outer edges of the markers.
double measure_blur(const io::Photograph& photo, const Target& target, const Rectification& place) {
    std::vector<double> each;
    for (const TargetMarker& marker : target.markers) {
        const double edge = marker.area.size().x(), cell = edge / marker_cells, reach = 0.95 * cell;
        constexpr int steps = 80, lines = 40;
        const Corners corners = corners_of(marker.area);
        for (std::size_t side = 0; side < 4; ++side) {
            const Vector2d along = (corners[(side + 1) % 4] - corners[side]).normalized(), inward(along.y(), -along.x());
            std::vector<double> profile(steps + 1, 0.0);
            bool inside = true;
            for (int line = 0; line < lines; ++line) {
                const Vector2d foot = corners[side] + along * edge * (0.15 + 0.7 * (line + 0.5) / lines);
                for (int step = 0; step <= steps; ++step) {
                    const Vector2d px = place.to_px(foot + inward * reach * (2.0 * step / steps - 1));
                    const double x = px.x() - 0.5, y = px.y() - 0.5;
                    if (!(x >= 0 && y >= 0 && x < photo.width_px - 1.0 && y < photo.height_px - 1.0)) {
                        inside = false;
                        continue;
                    }
                    const auto i = std::uint32_t(x), j = std::uint32_t(y);
                    const float u = float(x - i), v = float(y - j);
                    const auto value = [&](std::uint32_t a, std::uint32_t b) { return photo.pixels[photo.index(a, b)].sum(); };
                    profile[std::size_t(step)] += (1 - v) * ((1 - u) * value(i, j) + u * value(i + 1, j)) + v * ((1 - u) * value(i, j + 1) + u * value(i + 1, j + 1));
                }
            }
            if (!inside) continue;
            const double step_height = profile.front() - profile.back();
            if (!(step_height > 0)) continue;
            // From 2 % to 98 % of the step, so that noise in the flat parts does not count as spread: 10 - 90 % of a Gaussian edge is 2.563 deviations.
            const auto crossing = [&](double share) {
                const double level = profile.front() - share * step_height;
                for (int s = 1; s <= steps; ++s)
                    if (profile[std::size_t(s)] <= level) {
                        const double a = profile[std::size_t(s - 1)], b = profile[std::size_t(s)];
                        return (s - 1 + (a - level) / std::max(a - b, 1e-12)) * 2 * reach / steps;
                    }
                return 2 * reach;
            };
            each.push_back((crossing(0.9) - crossing(0.1)) / 2.563);
        }
    }
    if (each.empty()) return 0;
    std::nth_element(each.begin(), each.begin() + std::ptrdiff_t(each.size() / 2), each.end());
    return each[each.size() / 2];
}

}  // namespace

TargetView find_target(const io::Photograph& photograph, const Target& target, const std::optional<Corners>& corners) {
    std::vector<std::uint8_t> codes = finder_grey(photograph);
    const cv::Mat grey(int(photograph.height_px), int(photograph.width_px), CV_8UC1, codes.data());
    TargetView view;
    std::vector<Vector2d> plane, px;
    Rectification rough;
    if (corners) {
        check_corners(grey, target, *corners, photograph.name);
        rough = Rectification::fit(corners_of({Vector2d::Zero(), target.size_mm}), *corners);
        for (const TargetMarker& marker : target.markers)
            for (const Vector2d& p : corners_of(marker.area)) {
                plane.push_back(p);
                px.push_back(rough.to_px(p));
            }
        view.markers = 4;
    } else {
        const std::map<int, Corners> found = find_markers(grey, false), known = known_markers(found, target);
        if (known.size() < enough) fail_to_find(grey, found, target, photograph.name);
        for (const TargetMarker& marker : target.markers) {
            const auto at = known.find(marker.id);
            if (at == known.end()) continue;
            const Corners own = corners_of(marker.area);
            plane.insert(plane.end(), own.begin(), own.end());
            px.insert(px.end(), at->second.begin(), at->second.end());
        }
        view.markers = int(known.size());
        rough = Rectification::fit(plane, px);
    }
    const Vector2d middle = target.size_mm / 2;
    refine(grey, px, rough.px_per_unit(middle) * target.markers[0].area.size().x() / marker_cells);
    view.place = Rectification::fit(plane, px, &view.residual_px);
    view.px_per_mm = view.place.px_per_unit(middle);
    if (!(view.residual_px <= std::max(0.7, worst_residual * view.px_per_mm)))
        throw InputError(fmt::format("{}: the markers do not lie as the description says (they miss their places by {:.1f} pixels): another target, a bent one, or a lens that "
                                     "distorts; correct the lens first, or photograph from further away", photograph.name, view.residual_px));
    view.blur_mm = measure_blur(photograph, target, view.place);
    return view;
}

}  // namespace voxtone::calibration

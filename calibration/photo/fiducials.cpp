// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/photo/fiducials.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "calibration/photo/finder_picture.h"
#include "calibration/target/marker_pattern.h"
#include "optics/numerics/median.h"

namespace voxtone::calibration {

namespace {

using Eigen::Vector2d;
using Corners = std::array<Vector2d, 4>;  // upper left, upper right, lower right, lower left

constexpr std::size_t enough = 3;
constexpr double good_agreement = 0.7;  // of the markers' cells with the picture, 1 at most
constexpr double finder_px[] = {
    2400, 1400, 800};  // longest sides of the pictures in which markers are looked for: less of them, less blur
constexpr double worst_residual_mm = 0.15;  // mm: beyond this the markers do not lie as described

Corners corners_of(const Area& area) {
    return {Vector2d(area.min_mm.x(), area.max_mm.y()), area.max_mm, Vector2d(area.max_mm.x(), area.min_mm.y()),
            area.min_mm};
}

/// Markers in an 8-bit grey picture by number; corners in pixels.
std::map<int, Corners> find_markers(const cv::Mat& grey, bool inverted) {
    std::map<int, Corners> found;
    for (const double longest : finder_px) {
        const double scale = std::min(1.0, longest / std::max(grey.cols, grey.rows));
        cv::Mat small = grey;
        if (scale < 1) cv::resize(grey, small, {}, scale, scale, cv::INTER_AREA);
        for (MarkerView& marker : markers_in({small.data, small.total()}, small.cols, small.rows, inverted)) {
            for (Vector2d& corner : marker.corners) corner /= scale;
            found.try_emplace(marker.id, marker.corners);
        }
    }
    return found;
}

std::map<int, Corners> known_markers(const std::map<int, Corners>& found, const Target& target) {
    std::map<int, Corners> known;
    for (const TargetMarker& marker : target.markers)
        if (const auto at = found.find(marker.id); at != found.end()) known.insert(*at);
    return known;
}

float bilinear(const cv::Mat& grey, const Vector2d& p) {
    const double x = std::clamp(p.x() - 0.5, 0.0, grey.cols - 1.001),
                 y = std::clamp(p.y() - 0.5, 0.0, grey.rows - 1.001);
    const int i = int(x), j = int(y);
    const float u = float(x - i), v = float(y - j);
    const auto at = [&](int row, int column) { return float(grey.at<unsigned char>(row, column)); };
    return (1 - v) * ((1 - u) * at(j, i) + u * at(j, i + 1)) + v * ((1 - u) * at(j + 1, i) + u * at(j + 1, i + 1));
}

std::vector<int> numbers_of(const Target& target) {
    std::vector<int> numbers;
    for (const TargetMarker& marker : target.markers) numbers.push_back(marker.id);
    return numbers;
}

/// The homography through the corners of markers.
Rectification place_of(const std::map<int, Corners>& markers, const Target& target) {
    std::vector<Vector2d> plane, px;
    for (const TargetMarker& marker : target.markers) {
        const auto at = markers.find(marker.id);
        if (at == markers.end()) continue;
        const Corners own = corners_of(marker.area);
        plane.insert(plane.end(), own.begin(), own.end());
        px.insert(px.end(), at->second.begin(), at->second.end());
    }
    return Rectification::fit(plane, px);
}

/// How well the cells of all markers agree with the picture: 1 as they should be, -1 exchanged, about 0 elsewhere.
double agreement(const cv::Mat& grey, const Target& target, const Rectification& place) {
    std::vector<double> each;
    for (const TargetMarker& marker : target.markers) {
        const std::vector<bool> dark = marker_pattern(marker.id);
        const double cell = marker.area.size().x() / marker_cells;
        double sum = 0, sum_value = 0, sum_light = 0, value2 = 0, light2 = 0;
        for (int k = 0; k < marker_cells * marker_cells; ++k) {
            const Vector2d middle(marker.area.min_mm.x() + (k % marker_cells + 0.5) * cell,
                                  marker.area.max_mm.y() - (k / marker_cells + 0.5) * cell);
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
    return each[enough - 1];
}

[[noreturn]] void fail_to_find(const cv::Mat& grey, const std::map<int, Corners>& found, const Target& target,
                               const std::string& name) {
    const std::vector<int> wanted = numbers_of(target);
    cv::Mat mirrored;
    cv::flip(grey, mirrored, 1);
    if (known_markers(find_markers(mirrored, false), target).size() >= 2)
        throw InputError(
            fmt::format("{}: the target is mirrored. Either the picture was mirrored, or the printer mirrors what it "
                        "prints: then set flip_x in its profile "
                        "and print the target again, for all other prints are mirrored as well",
                        name));
    const std::map<int, Corners> either = known_markers(find_markers(grey, true), target);
    if (either.size() >= enough && agreement(grey, target, place_of(either, target)) < -good_agreement)
        throw InputError(
            fmt::format("{}: the markers are light on dark: the resins {} and {} were exchanged when they were "
                        "assigned to the bitmaps' colours, or the picture "
                        "is a negative. Every square would be taken for another one; print again with the resins as "
                        "the assignment sheet says",
                        name, target.light, target.dark));
    if (found.size() >= enough && known_markers(found, target).size() < found.size()) {
        std::vector<int> there;
        for (const auto& [id, corners] : found) there.push_back(id);
        throw InputError(
            fmt::format("{}: this is another target: its markers are {}, those of the description are {}. Give the "
                        "target.json that lay beside the layers which "
                        "were printed",
                        name, fmt::join(there, ", "), fmt::join(wanted, ", ")));
    }
    throw InputError(
        fmt::format("{}: no target found: {} of the markers {} are seen, {} are needed. The whole target must be in "
                    "the picture, sharp, with its light frame "
                    "(at least 5 pixels per marker cell, no glare on the markers); or give the corners of the slab by "
                    "hand with --corners",
                    name, known_markers(found, target).size(), fmt::join(wanted, ", "), enough));
}

/// Says which other way the corners would fit.
void check_corners(const cv::Mat& grey, const Target& target, const Corners& given, const std::string& name) {
    const Corners own = corners_of({Vector2d::Zero(), target.size_mm});
    const auto place = [&](int turn, bool mirrored) {
        Corners px;
        for (std::size_t c = 0; c < 4; ++c)
            px[c] = given[(mirrored ? 4 + std::size_t(turn) - c : c + std::size_t(turn)) % 4];
        return Rectification::fit(own, px);
    };
    const double as_given = agreement(grey, target, place(0, false));
    if (as_given > good_agreement) return;
    for (int turn = 0; turn < 4; ++turn)
        for (const bool mirrored : {false, true}) {
            const double fits = agreement(grey, target, place(turn, mirrored));
            if (fits < -good_agreement)
                throw InputError(fmt::format(
                    "{}: at the given corners the markers are light on dark: the resins {} and {} are exchanged", name,
                    target.light, target.dark));
            if (fits > good_agreement)
                throw InputError(mirrored
                                     ? fmt::format("{}: at the given corners the target is mirrored, or the corners "
                                                   "are given anticlockwise; they must be upper left, upper "
                                                   "right, lower right, lower left",
                                                   name)
                                     : fmt::format("{}: the given corners are those of the target turned by {} "
                                                   "degrees; the first must be the upper left one, beside marker {}",
                                                   name, 90 * turn, target.markers[0].id));
        }
    throw InputError(
        fmt::format("{}: between the given corners there are not the markers of the description ({}); are these the "
                    "corners of the slab, in the order upper "
                    "left, upper right, lower right, lower left, and is it this target?",
                    name, fmt::join(numbers_of(target), ", ")));
}

constexpr int profile_steps = 80;

/// Brightness along a line across an outer edge of a marker, from the light side to the dark one; nothing outside of
/// the picture.
std::optional<std::vector<double>> profile_across(const io::Photograph& photo, const Rectification& place,
                                                  const Vector2d& foot, const Vector2d& inward, double reach) {
    std::vector<double> profile;
    for (int step = 0; step <= profile_steps; ++step) {
        const Vector2d px = place.to_px(foot + inward * reach * (2.0 * step / profile_steps - 1));
        const double x = px.x() - 0.5, y = px.y() - 0.5;
        if (!(x >= 0 && y >= 0 && x < photo.width_px - 1.0 && y < photo.height_px - 1.0)) return std::nullopt;
        const auto i = std::uint32_t(x), j = std::uint32_t(y);
        const float u = float(x - i), v = float(y - j);
        const auto value = [&](std::uint32_t a, std::uint32_t b) { return photo.pixels[photo.index(a, b)].sum(); };
        profile.push_back((1 - v) * ((1 - u) * value(i, j) + u * value(i + 1, j)) +
                          v * ((1 - u) * value(i, j + 1) + u * value(i + 1, j + 1)));
    }
    return profile;
}

/// Where a falling profile has lost this share of its height, in [-1, 1] from end to end; nothing where it does not
/// fall.
std::optional<double> crossing(const std::vector<double>& profile, double share) {
    const double height = profile.front() - profile.back();
    if (!(height > 0.2 * std::abs(profile.front()))) return std::nullopt;
    const double level = profile.front() - share * height;
    for (int s = 1; s <= profile_steps; ++s)
        if (profile[std::size_t(s)] <= level) {
            const double a = profile[std::size_t(s - 1)], b = profile[std::size_t(s)];
            return 2 * (s - 1 + (a - level) / std::max(a - b, 1e-12)) / profile_steps - 1;
        }
    return std::nullopt;
}

struct Side {
    Vector2d from, along, inward;
    double length;
};

std::array<Side, 4> sides_of(const Area& area) {
    const Corners corners = corners_of(area);
    std::array<Side, 4> sides;
    for (std::size_t side = 0; side < 4; ++side) {
        const Vector2d along = (corners[(side + 1) % 4] - corners[side]).normalized();
        sides[side] = {corners[side], along, {along.y(), -along.x()}, area.size().x()};
    }
    return sides;
}

/// Corners of a marker as crossings of lines through its edges: blur rounds a corner, it does not move an edge.
std::optional<Corners> refined_corners(const io::Photograph& photo, const Rectification& place, const Area& area) {
    constexpr int points_per_side = 30;
    const double reach = 0.8 * area.size().x() / marker_cells;
    std::array<Eigen::Vector3d, 4> lines;
    const std::array<Side, 4> sides = sides_of(area);
    for (std::size_t side = 0; side < 4; ++side) {
        const Side& s = sides[side];
        std::vector<cv::Point2f> points;
        for (int k = 0; k < points_per_side; ++k) {
            const Vector2d foot = s.from + s.along * s.length * (0.12 + 0.76 * (k + 0.5) / points_per_side);
            const auto profile = profile_across(photo, place, foot, s.inward, reach);
            const auto half = profile ? crossing(*profile, 0.5) : std::nullopt;
            if (!half) continue;
            const Vector2d px = place.to_px(foot + s.inward * reach * *half);
            points.emplace_back(float(px.x()), float(px.y()));
        }
        if (points.size() < points_per_side / 2) return std::nullopt;
        cv::Vec4f line;
        cv::fitLine(points, line, cv::DIST_HUBER, 0, 0.01, 0.001);
        lines[side] =
            Eigen::Vector3d(line[2], line[3], 1).cross(Eigen::Vector3d(line[2] + line[0], line[3] + line[1], 1));
    }
    Corners corners;
    for (std::size_t c = 0; c < 4; ++c) corners[c] = lines[(c + 3) % 4].cross(lines[c]).hnormalized();
    return corners;
}

/// Standard deviation of the blur, mm: 10 % to 90 % of a Gaussian edge are 2.563 of them. Median over the markers'
/// edges.
double measure_blur(const io::Photograph& photo, const Target& target, const Rectification& place) {
    constexpr int lines = 40;
    std::vector<double> each;
    for (const TargetMarker& marker : target.markers) {
        const double reach = 0.95 * marker.area.size().x() / marker_cells;
        for (const Side& side : sides_of(marker.area)) {
            std::vector<double> mean(profile_steps + 1, 0.0);
            int used = 0;
            for (int line = 0; line < lines; ++line) {
                const auto profile = profile_across(
                    photo, place, side.from + side.along * side.length * (0.15 + 0.7 * (line + 0.5) / lines),
                    side.inward, reach);
                if (!profile) continue;
                for (std::size_t step = 0; step < mean.size(); ++step) mean[step] += (*profile)[step];
                ++used;
            }
            if (used < lines / 2) continue;
            const auto first = crossing(mean, 0.1), last = crossing(mean, 0.9);
            if (first && last) each.push_back((*last - *first) * reach / 2.563);
        }
    }
    return optics::median(std::move(each));
}

}  // namespace

TargetView find_target(const io::Photograph& photograph, const Target& target, const std::optional<Corners>& corners) {
    std::vector<std::uint8_t> codes = finder_grey(photograph);
    const cv::Mat grey(int(photograph.height_px), int(photograph.width_px), CV_8UC1, codes.data());
    TargetView view;
    Rectification rough;
    std::vector<const TargetMarker*> seen;
    if (corners) {
        check_corners(grey, target, *corners, photograph.name);
        rough = Rectification::fit(corners_of({Vector2d::Zero(), target.size_mm}), *corners);
        for (const TargetMarker& marker : target.markers) seen.push_back(&marker);
    } else {
        const std::map<int, Corners> found = find_markers(grey, false), known = known_markers(found, target);
        if (known.size() < enough) fail_to_find(grey, found, target, photograph.name);
        rough = place_of(known, target);
        for (const TargetMarker& marker : target.markers)
            if (known.contains(marker.id)) seen.push_back(&marker);
    }
    const Vector2d middle = target.size_mm / 2;
    view.place = rough;
    constexpr int rounds = 2;  // the second from where the first put the edges
    for (int round = 0; round < rounds; ++round) {
        std::vector<Vector2d> plane, px;
        view.markers = 0;
        for (const TargetMarker* marker : seen) {
            const auto refined = refined_corners(photograph, view.place, marker->area);
            if (!refined) continue;
            const Corners own = corners_of(marker->area);
            plane.insert(plane.end(), own.begin(), own.end());
            px.insert(px.end(), refined->begin(), refined->end());
            ++view.markers;
        }
        if (view.markers < int(enough))
            throw InputError(
                fmt::format("{}: the edges of the markers cannot be told from what is beside them on more than {} of "
                            "them: the photograph is blurred or has glare on the markers",
                            photograph.name, view.markers));
        view.place = Rectification::fit(plane, px, &view.residual_px);
    }
    view.px_per_mm = view.place.px_per_unit(middle);
    view.blur_mm = measure_blur(photograph, target, view.place);
    const double cell_mm = target.markers[0].area.size().x() / marker_cells;
    constexpr double blurred_cells = 0.3;  // beyond this the edges of neighbouring cells reach each other
    const bool misplaced = !(view.residual_px <= std::max(0.7, worst_residual_mm * view.px_per_mm));
    if (misplaced && view.blur_mm > blurred_cells * cell_mm)
        throw InputError(
            fmt::format("{}: the photograph is too blurred for the markers to be located: edges spread over {:.2f} mm "
                        "({:.1f} pixels, one standard deviation); focus, and use a tripod",
                        photograph.name, view.blur_mm, view.blur_mm * view.px_per_mm));
    if (misplaced)
        throw InputError(
            fmt::format("{}: the markers do not lie as the description says (they miss their places by {:.1f} pixels): "
                        "another target, a bent one, or a lens that "
                        "distorts; correct the lens first, or photograph from further away",
                        photograph.name, view.residual_px));
    return view;
}

}  // namespace voxtone::calibration

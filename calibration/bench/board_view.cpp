// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/bench/board_view.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "calibration/photo/finder_picture.h"
#include "optics/numerics/median.h"

namespace voxtone::calibration {
namespace {

using Eigen::Vector2d;

constexpr double small_px = 1000;  // longest side of the picture in which crossings are looked for
constexpr int ring_px = 6, most_crossings = 90;
constexpr std::size_t least_corners = 6;
constexpr double least_square_px = 24;  // of the small picture
constexpr double near_node = 0.08;      // of a square: a crossing that belongs to a node
constexpr double most_residual_px = 1.5, most_turn_deg = 15, most_tilt_deg = 12;
constexpr double least_contrast = 0.3;  // (white - black) / (white + black) of the squares

struct SmallPicture {
    cv::Mat grey;
    double scale;
};

SmallPicture small_picture(const io::Photograph& photo) {
    std::vector<std::uint8_t> codes = finder_grey(photo);
    const cv::Mat whole(int(photo.height_px), int(photo.width_px), CV_8UC1, codes.data());
    const double scale = std::min(1.0, small_px / std::max(whole.cols, whole.rows));
    cv::Mat small;
    cv::resize(whole, small, {}, scale, scale, cv::INTER_AREA);
    small.convertTo(small, CV_32F);
    cv::GaussianBlur(small, small, {}, 1.2);
    return {small, scale};
}

// Large where the ring around a pixel is light, dark, light, dark by quarters.
cv::Mat ring_response(const cv::Mat& grey) {
    std::array<cv::Point, 16> ring;
    for (std::size_t k = 0; k < ring.size(); ++k) {
        const double angle = 2 * CV_PI * double(k) / double(ring.size());
        ring[k] = {int(std::lround(ring_px * std::cos(angle))), int(std::lround(ring_px * std::sin(angle)))};
    }
    cv::Mat response = cv::Mat::zeros(grey.size(), CV_32F);
    for (int y = ring_px; y < grey.rows - ring_px; ++y)
        for (int x = ring_px; x < grey.cols - ring_px; ++x) {
            std::array<float, 16> I;
            float mean = 0, across = 0, opposite = 0;
            for (std::size_t k = 0; k < 16; ++k) {
                I[k] = grey.at<float>(y + ring[k].y, x + ring[k].x);
                mean += I[k] / 16;
            }
            for (std::size_t k = 0; k < 4; ++k) across += std::abs(I[k] + I[k + 8] - I[k + 4] - I[k + 12]);
            for (std::size_t k = 0; k < 8; ++k) opposite += std::abs(I[k] - I[k + 8]);
            const float here = (grey.at<float>(y, x) + grey.at<float>(y - 1, x) + grey.at<float>(y + 1, x) +
                                grey.at<float>(y, x - 1) + grey.at<float>(y, x + 1)) /
                               5;
            response.at<float>(y, x) = across - opposite - 16 * std::abs(mean - here);
        }
    return response;
}

std::vector<Vector2d> find_crossings(const cv::Mat& grey) {
    const cv::Mat response = ring_response(grey);
    cv::Mat most;
    cv::dilate(response, most, cv::Mat::ones(2 * ring_px + 1, 2 * ring_px + 1, CV_8U));
    std::vector<std::pair<float, Vector2d>> found;
    constexpr float least_response = 40;
    for (int y = 0; y < grey.rows; ++y)
        for (int x = 0; x < grey.cols; ++x)
            if (const float r = response.at<float>(y, x); r > least_response && r == most.at<float>(y, x))
                found.emplace_back(r, Vector2d(x + 0.5, y + 0.5));
    std::ranges::stable_sort(found, [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<Vector2d> crossings;
    for (const auto& [r, p] : found)
        if (crossings.size() < most_crossings && r > 0.15f * found.front().first) crossings.push_back(p);
    return crossings;
}

struct Lattice {
    Vector2d origin = Vector2d::Zero(), u = Vector2d::Zero();  // the other side is u turned by 90 degrees
    double score = 0;
    [[nodiscard]] Vector2d at(const Vector2d& p) const {
        const Vector2d d = p - origin, v(-u.y(), u.x());
        return Vector2d(d.dot(u), d.dot(v)) / u.squaredNorm();
    }
};

Vector2d nearest_node(const Vector2d& at) { return at.array().round().matrix(); }

// The square lattice through two crossings that explains most of the others with fewest nodes left empty.
Lattice find_lattice(const std::vector<Vector2d>& crossings, const cv::Size& size) {
    Lattice best;
    for (std::size_t i = 0; i < crossings.size(); ++i)
        for (std::size_t j = 0; j < crossings.size(); ++j) {
            Lattice trial{crossings[i], crossings[j] - crossings[i], 0};
            // Along x rather than along y, so that each lattice is tried once.
            if (trial.u.x() < std::abs(trial.u.y()) || trial.u.norm() < least_square_px) continue;
            double explained = 0;
            for (const Vector2d& p : crossings) {
                const Vector2d at = trial.at(p), node = nearest_node(at);
                explained += (at - node).norm() < near_node * (1 + 0.1 * node.norm());
            }
            const double nodes = size.area() / trial.u.squaredNorm();
            trial.score = explained * explained / std::max(nodes, explained);
            if (explained >= double(least_corners) && trial.score > best.score) best = trial;
        }
    return best;
}

struct Nodes {
    std::vector<Vector2d> node, px;
};

Nodes nodes_of(const std::vector<Vector2d>& crossings, const Rectification& place) {
    Nodes nodes;
    for (const Vector2d& p : crossings) {
        const Vector2d at = place.from_px(p), node = nearest_node(at);
        if ((at - node).norm() > near_node) continue;
        nodes.node.push_back(node);
        nodes.px.push_back(p);
    }
    return nodes;
}

std::optional<Rectification> robust_place(const Nodes& nodes, double reach_px, double* residual_px, int* used) {
    if (nodes.node.size() < least_corners) return std::nullopt;
    std::vector<cv::Point2d> from, to;
    for (std::size_t k = 0; k < nodes.node.size(); ++k) {
        from.emplace_back(nodes.node[k].x(), nodes.node[k].y());
        to.emplace_back(nodes.px[k].x(), nodes.px[k].y());
    }
    std::vector<unsigned char> good;
    static_cast<void>(cv::findHomography(from, to, cv::RANSAC, reach_px, good, 2000, 0.999));
    Nodes kept;
    for (std::size_t k = 0; k < good.size(); ++k)
        if (good[k]) kept.node.push_back(nodes.node[k]), kept.px.push_back(nodes.px[k]);
    if (kept.node.size() < least_corners) return std::nullopt;
    *used = int(kept.node.size());
    return Rectification::fit(kept.node, kept.px, residual_px);
}

cv::Mat full_grey(const io::Photograph& photo) {
    cv::Mat grey(int(photo.height_px), int(photo.width_px), CV_32F);
    for (std::uint32_t y = 0; y < photo.height_px; ++y)
        for (std::uint32_t x = 0; x < photo.width_px; ++x)
            grey.at<float>(int(y), int(x)) = photo.pixels[photo.index(x, y)].sum();
    return grey;
}

Nodes refined(const cv::Mat& grey, const Nodes& rough, double square_px) {
    std::vector<cv::Point2f> corners;
    for (const Vector2d& p : rough.px) corners.emplace_back(float(p.x() - 0.5), float(p.y() - 0.5));
    const int reach = std::clamp(int(0.12 * square_px), 4, 40);
    cv::cornerSubPix(grey, corners, {reach, reach}, {-1, -1},
                     {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 60, 1e-3});
    Nodes result;
    for (std::size_t k = 0; k < corners.size(); ++k) {
        const Vector2d px(corners[k].x + 0.5, corners[k].y + 0.5);
        if ((px - rough.px[k]).norm() > 0.05 * square_px + 3) continue;
        result.node.push_back(rough.node[k]);
        result.px.push_back(px);
    }
    return result;
}

// Middle part of a square of the lattice in the picture; nothing where it is cut off.
std::optional<double> square_level(const cv::Mat& grey, const Rectification& place, const Vector2d& corner) {
    double sum = 0;
    constexpr int steps = 8;
    for (int k = 0; k < steps * steps; ++k) {
        const Vector2d own((k % steps + 0.5) / steps, (k / steps + 0.5) / steps);
        const Vector2d px = place.to_px(corner + Vector2d(0.2, 0.2) + 0.6 * own);
        if (!(px.x() >= 0 && px.y() >= 0 && px.x() < grey.cols && px.y() < grey.rows)) return std::nullopt;
        sum += double(grey.at<float>(int(px.y()), int(px.x()))) / (steps * steps);
    }
    return sum;
}

// Contrast of the squares at even nodes against those at odd ones: median of each, so that the slab counts for little.
double parity_contrast(const cv::Mat& grey, const Rectification& place) {
    std::array<std::vector<double>, 2> levels;
    constexpr int reach = 24;
    const Vector2d middle = nearest_node(place.from_px(Vector2d(grey.cols, grey.rows) / 2));
    for (int b = -reach; b <= reach; ++b)
        for (int a = -reach; a <= reach; ++a) {
            const Vector2d corner = middle + Vector2d(a, b);
            const auto level = square_level(grey, place, corner);
            if (level) levels[std::size_t(std::lround(corner.sum()) & 1)].push_back(*level);
        }
    if (levels[0].empty() || levels[1].empty()) return 0;
    const double even = optics::median(levels[0]), odd = optics::median(levels[1]);
    return (even - odd) / std::max(even + odd, 1e-12);
}

[[noreturn]] void no_board(const std::string& name, double square_mm) {
    throw InputError(
        fmt::format("{}: no checkerboard found: at least {} crossings of its {:g} mm squares must be seen around the "
                    "slab, sharp and evenly lit; without it there is no edge to measure and no scale",
                    name, least_corners, square_mm));
}

// From mm about the edge's middle to nodes of the lattice.
Eigen::Matrix3d nodes_from_mm(const Vector2d& middle, bool turned, double square_mm) {
    const double s = (turned ? -1 : 1) / square_mm;
    Eigen::Matrix3d A = Eigen::Matrix3d::Identity();
    A(0, 0) = s;
    A(1, 1) = -s;
    A.topRightCorner<2, 1>() = middle;
    return A;
}

Eigen::Matrix3d matrix_of(const Rectification& place) {
    // From four points: a homography gives no matrix away, but is one.
    std::vector<cv::Point2d> from, to;
    for (const Vector2d& p : {Vector2d(-1, -1), Vector2d(1, -1), Vector2d(1, 1), Vector2d(-1, 1)}) {
        const Vector2d px = place.to_px(p);
        from.emplace_back(p.x(), p.y());
        to.emplace_back(px.x(), px.y());
    }
    const cv::Mat found = cv::findHomography(from, to, 0);
    Eigen::Matrix3d H;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) H(row, column) = found.at<double>(row, column);
    return H;
}

void check_view(const BoardView& view, const std::string& name) {
    if (view.residual_px > most_residual_px)
        throw InputError(
            fmt::format("{}: the checkerboard's corners miss a flat board by {:.1f} pixels: bent paper, or a lens that "
                        "distorts; glue the sheet on something flat, photograph from further away",
                        name, view.residual_px));
    if (std::abs(view.turn_deg) > most_turn_deg)
        throw InputError(
            fmt::format("{}: the edge is turned by {:.1f} degrees from upright, more than the {:g} that can be "
                        "straightened without loss; turn the camera or the sheet",
                        name, view.turn_deg, most_turn_deg));
    if (view.tilt_deg > most_tilt_deg)
        throw InputError(
            fmt::format("{}: the sheet is seen from about {:.0f} degrees aside (its squares are not square), but the "
                        "scene that is fitted is seen from straight above; level the camera",
                        name, view.tilt_deg));
}

}  // namespace

BoardView find_board(const io::Photograph& photo, double square_mm) {
    const SmallPicture small = small_picture(photo);
    std::vector<Vector2d> crossings = find_crossings(small.grey);
    const Lattice lattice = find_lattice(crossings, small.grey.size());
    if (lattice.score == 0) no_board(photo.name, square_mm);
    for (Vector2d& p : crossings) p /= small.scale;

    Eigen::Matrix3d H = Eigen::Matrix3d::Identity();
    H.col(0).head<2>() = lattice.u / small.scale;
    H.col(1).head<2>() = Vector2d(-lattice.u.y(), lattice.u.x()) / small.scale;
    H.topRightCorner<2, 1>() = lattice.origin / small.scale;
    Rectification place(H);
    const double square_px = lattice.u.norm() / small.scale;
    BoardView view;
    // From where the lattice was found outwards: perspective and turn add up with the distance.
    for (int round = 0; round < 3; ++round) {
        const auto next = robust_place(nodes_of(crossings, place), 0.03 * square_px, &view.residual_px, &view.corners);
        if (!next) no_board(photo.name, square_mm);
        place = *next;
    }
    const cv::Mat grey = full_grey(photo);
    const auto fine =
        robust_place(refined(grey, nodes_of(crossings, place), square_px), 1.0, &view.residual_px, &view.corners);
    if (!fine) no_board(photo.name, square_mm);
    place = *fine;

    const double contrast = parity_contrast(grey, place);
    if (std::abs(contrast) < least_contrast) no_board(photo.name, square_mm);
    const Vector2d centre = place.from_px(Vector2d(photo.width_px, photo.height_px) / 2);
    const Vector2d foot(std::round(centre.x()), std::floor(centre.y()));
    const bool even = (std::lround(foot.sum()) & 1) == 0, white_right = even == (contrast > 0);
    const Eigen::Matrix3d to_px = matrix_of(place) * nodes_from_mm(foot + Vector2d(0, 0.5), !white_right, square_mm);
    view.place = Rectification(to_px);
    view.px_per_mm = view.place.px_per_unit(Vector2d::Zero());
    const Vector2d up = view.place.to_px({0, 5}) - view.place.to_px({0, -5}),
                   along = view.place.to_px({5, 0}) - view.place.to_px({-5, 0});
    const double turn = std::atan2(up.x(), -up.y()) * 180 / CV_PI;
    view.turn_deg = turn > 90 ? turn - 180 : turn < -90 ? turn + 180 : turn;
    const double ratio = std::min(up.norm(), along.norm()) / std::max(up.norm(), along.norm());
    view.tilt_deg = std::acos(std::min(1.0, ratio)) * 180 / CV_PI;
    check_view(view, photo.name);
    return view;
}

}  // namespace voxtone::calibration

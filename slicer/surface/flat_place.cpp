// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/flat_place.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <tuple>

#include "slicer/surface/seen_depth.h"

namespace voxtone::slicer {

namespace {

constexpr double finest_mm = 0.1;
constexpr int most_squares = 600;
constexpr double steepest = 1.2;  // tan 50 degrees
constexpr double flat_mm = 0.02;  // below a layer: no flatter than another
constexpr float nowhere = std::numeric_limits<float>::infinity();

/// Values on a grid, rows from the bottom.
struct Field {
    int columns, rows;
    std::vector<float> value;
    [[nodiscard]] float& at(int i, int j) { return value[std::size_t(j) * std::size_t(columns) + std::size_t(i)]; }
    [[nodiscard]] float at(int i, int j) const { return value[std::size_t(j) * std::size_t(columns) + std::size_t(i)]; }
};

/// The largest of each `window` values in a row of them, by a queue of those that may still be it (D. Lemire 2006,
/// "Streaming maximum-minimum filter").
std::vector<float> sliding_largest(const std::vector<float>& values, int window) {
    std::vector<float> largest;
    std::deque<std::size_t> queue;
    for (std::size_t i = 0; i < values.size(); ++i) {
        while (!queue.empty() && values[queue.back()] <= values[i]) queue.pop_back();
        queue.push_back(i);
        if (queue.front() + std::size_t(window) <= i) queue.pop_front();
        if (i + 1 >= std::size_t(window)) largest.push_back(values[queue.front()]);
    }
    return largest;
}

/// The largest in each window of so many columns and rows, by the window's lower left cell.
Field largest_in_windows(const Field& field, int columns, int rows) {
    Field across{field.columns - columns + 1, field.rows, {}};
    for (int j = 0; j < field.rows; ++j) {
        const auto row = field.value.begin() + std::ptrdiff_t(j) * field.columns;
        const std::vector<float> largest = sliding_largest({row, row + field.columns}, columns);
        across.value.insert(across.value.end(), largest.begin(), largest.end());
    }
    Field all{across.columns, field.rows - rows + 1, {}};
    all.value.resize(std::size_t(all.columns) * std::size_t(all.rows));
    for (int i = 0; i < all.columns; ++i) {
        std::vector<float> column;
        for (int j = 0; j < across.rows; ++j) column.push_back(across.at(i, j));
        const std::vector<float> largest = sliding_largest(column, rows);
        for (int j = 0; j < all.rows; ++j) all.at(i, j) = largest[std::size_t(j)];
    }
    return all;
}

/// The body from a side: the rectangle that holds all of it, its depths.
struct View {
    MarkFrame frame;
    double cell_mm;
    Field depth;
};

View view_of(const SolidMesh& body, const MarkAxes& axes) {
    Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const Eigen::Vector3d& p : body.positions_mm) {
        const Eigen::Vector3d seen(axes.right.dot(p), axes.up.dot(p), axes.out.dot(p));
        low = low.cwiseMin(seen);
        high = high.cwiseMax(seen);
    }
    const Eigen::Vector3d size = high - low;
    View view{{axes, low.x() * axes.right + low.y() * axes.up + high.z() * axes.out, size.x(), size.y()},
              std::max(finest_mm, std::max(size.x(), size.y()) / most_squares),
              {}};
    // A whole number of cells; points lie in their middles.
    const auto cells = [&](double mm) { return std::max(2, int(std::floor(mm / view.cell_mm))); };
    view.depth.columns = cells(size.x());
    view.depth.rows = cells(size.y());
    MarkFrame points = view.frame;
    points.width_mm = (view.depth.columns - 1) * view.cell_mm;
    points.height_mm = (view.depth.rows - 1) * view.cell_mm;
    points.corner_mm = view.frame.at((size.x() - points.width_mm) / 2, (size.y() - points.height_mm) / 2);
    view.frame = points;
    view.depth.value = depth_below(points, body, view.cell_mm * (1 + 1e-9)).depth_mm;
    return view;
}

bool lies_in(const MarkFrame& frame, const Eigen::Vector3d& point, double margin_mm) {
    const Eigen::Vector3d offset = point - frame.corner_mm;
    const double along = frame.axes.right.dot(offset), up = frame.axes.up.dot(offset);
    return along > -margin_mm && along < frame.width_mm + margin_mm && up > -margin_mm &&
           up < frame.height_mm + margin_mm;
}

/// 1 where no part of a mark may lie: beside the body, on steps and steep slopes, on other marks; else 0.
Field barred(const View& view, std::span<const MarkFrame> taken) {
    constexpr double beside_others_mm = 0.5, same_side = 0.9;
    const Field& depth = view.depth;
    Field bars{depth.columns, depth.rows, std::vector<float>(depth.value.size(), 0)};
    const float step = float(steepest * view.cell_mm);
    for (int j = 0; j < depth.rows; ++j)
        for (int i = 0; i < depth.columns; ++i) {
            const float here = depth.at(i, j);
            bool bar = !std::isfinite(here);
            if (i + 1 < depth.columns) bar = bar || !(std::abs(depth.at(i + 1, j) - here) <= step);
            if (j + 1 < depth.rows) bar = bar || !(std::abs(depth.at(i, j + 1) - here) <= step);
            for (const MarkFrame& other : taken)
                if (!bar && other.axes.out.dot(view.frame.axes.out) > same_side)
                    bar = lies_in(other, view.frame.at(i * view.cell_mm, j * view.cell_mm, double(here)),
                                  beside_others_mm);
            bars.at(i, j) = bar ? 1.0f : 0.0f;
        }
    return bars;
}

struct Found {
    double unevenness_mm;
    std::size_t places;  ///< as flat as this one
    Eigen::Vector3d middle;
};

std::optional<Found> flattest_in(const View& view, double width_mm, double height_mm,
                                 std::span<const MarkFrame> taken) {
    const int columns = int(std::ceil(width_mm / view.cell_mm - 1e-6)) + 1,
              rows = int(std::ceil(height_mm / view.cell_mm - 1e-6)) + 1;
    if (columns > view.depth.columns || rows > view.depth.rows) return std::nullopt;
    const Field bars = largest_in_windows(barred(view, taken), columns, rows);
    Field deep = view.depth, shallow = view.depth;
    for (float& v : deep.value) v = std::isfinite(v) ? v : 0;
    for (float& v : shallow.value) v = std::isfinite(v) ? -v : -nowhere;
    deep = largest_in_windows(deep, columns, rows);
    shallow = largest_in_windows(shallow, columns, rows);
    float least = nowhere;
    for (std::size_t p = 0; p < bars.value.size(); ++p)
        if (bars.value[p] == 0) least = std::min(least, deep.value[p] + shallow.value[p]);
    if (!std::isfinite(least)) return std::nullopt;
    const float enough = std::max(least, float(flat_mm)) * 1.01f;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    std::vector<std::array<int, 2>> places;
    for (int j = 0; j < bars.rows; ++j)
        for (int i = 0; i < bars.columns; ++i)
            if (bars.at(i, j) == 0 && deep.at(i, j) + shallow.at(i, j) <= enough) {
                places.push_back({i, j});
                sum += Eigen::Vector2d(i, j);
            }
    const Eigen::Vector2d centre = sum / double(places.size());
    const auto from_centre = [&](const std::array<int, 2>& p) {
        return (Eigen::Vector2d(p[0], p[1]) - centre).squaredNorm();
    };
    const std::array<int, 2> best = *std::ranges::min_element(places, {}, from_centre);
    const double x = (best[0] + (columns - 1) / 2.0) * view.cell_mm, y = (best[1] + (rows - 1) / 2.0) * view.cell_mm;
    return Found{std::max(double(least), flat_mm), places.size(),
                 view.frame.at(x, y, -double(shallow.at(best[0], best[1])))};
}

}  // namespace

std::vector<Eigen::Vector3d> facing_directions(const SolidMesh& body) {
    std::vector<Eigen::Vector3d> outs{-Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ(),
                                      -Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitY()};
    constexpr double bins_a_unit = 50;
    constexpr std::size_t most_others = 8;
    std::map<std::array<int, 3>, Eigen::Vector3d> area;
    for (const auto& t : body.triangles) {
        const Eigen::Vector3d& a = body.positions_mm[t[0]];
        const Eigen::Vector3d normal = 0.5 * (body.positions_mm[t[1]] - a).cross(body.positions_mm[t[2]] - a);
        if (!(normal.norm() > 0)) continue;
        const Eigen::Vector3d bin = normal.normalized() * bins_a_unit;
        auto [found, is_new] = area.try_emplace(
            {int(std::lround(bin.x())), int(std::lround(bin.y())), int(std::lround(bin.z()))}, Eigen::Vector3d::Zero());
        found->second += normal;
    }
    std::vector<Eigen::Vector3d> sums;
    for (const auto& [bin, sum] : area) sums.push_back(sum);
    std::ranges::stable_sort(sums, std::greater(), [](const Eigen::Vector3d& sum) { return sum.norm(); });
    constexpr double same = 0.9998;  // a degree
    for (const Eigen::Vector3d& sum : sums) {
        if (outs.size() >= 6 + most_others) break;
        const Eigen::Vector3d out = sum.normalized();
        if (std::ranges::none_of(outs, [&](const Eigen::Vector3d& other) { return other.dot(out) > same; }))
            outs.push_back(out);
    }
    return outs;
}

std::optional<MarkFrame> flattest_place(const SolidMesh& body, std::span<const Eigen::Vector3d> outs,
                                        const FlatQuery& query) {
    std::optional<Found> best;
    MarkAxes best_axes;
    for (const Eigen::Vector3d& out : outs) {
        const MarkAxes axes = axes_facing(out).turned(query.turn_deg);
        const std::optional<Found> found =
            flattest_in(view_of(body, axes), query.width_mm, query.height_mm, query.taken);
        if (!found || found->unevenness_mm > query.most_uneven_mm) continue;
        const bool better = !best || found->unevenness_mm < best->unevenness_mm * 0.99 ||
                            (found->unevenness_mm < best->unevenness_mm * 1.01 && found->places > best->places);
        if (!better) continue;
        best = found;
        best_axes = axes;
    }
    if (!best) return std::nullopt;
    return MarkFrame::around(best->middle, best_axes, query.width_mm, query.height_mm);
}

std::optional<MarkFrame> first_flat_place(const SolidMesh& body, std::span<const std::vector<Eigen::Vector3d>> sides,
                                          FlatQuery query) {
    // An arc of this rise leans by 23 degrees at its ends, and letters there are 8 % narrower.
    constexpr double most_rise = 0.1;
    query.most_uneven_mm = std::max(most_rise * std::max(query.width_mm, query.height_mm), flat_mm);
    for (const std::vector<Eigen::Vector3d>& outs : sides)
        if (const auto found = flattest_place(body, outs, query)) return found;
    return std::nullopt;
}

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/texel_coverage.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace voxtone::io {

namespace {

using Point = Eigen::Vector2d;

struct Interval {
    double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
    void add(double x) {
        low = std::min(low, x);
        high = std::max(high, x);
    }
};

/// Extent in x of the part of the triangle with y in [y0, y1].
Interval extent_in_band(const std::array<Point, 3>& p, double y0, double y1) {
    Interval extent;
    for (int i = 0; i < 3; ++i) {
        const Point &a = p[i], &b = p[(i + 1) % 3];
        if (a.y() >= y0 && a.y() <= y1) extent.add(a.x());
        for (const double y : {y0, y1}) {
            if ((a.y() < y) == (b.y() < y)) continue;
            extent.add(a.x() + (b.x() - a.x()) * ((y - a.y()) / (b.y() - a.y())));
        }
    }
    return extent;
}

double thickness(const std::array<Point, 3>& p) {
    const Point a = p[1] - p[0], b = p[2] - p[0];
    const double longest = std::max({a.norm(), b.norm(), (p[2] - p[1]).norm()});
    return longest > 0 ? std::abs(a.x() * b.y() - a.y() * b.x()) / longest : 0;
}

std::int64_t modulo(std::int64_t i, std::int64_t n) {
    const std::int64_t r = i % n;
    return r < 0 ? r + n : r;
}

/// The texel that index i means; -1: none.
std::int64_t wrapped(std::int64_t i, std::int64_t n, Wrap wrap) {
    switch (wrap) {
        case Wrap::repeat:
            return modulo(i, n);
        case Wrap::mirror: {
            const std::int64_t r = modulo(i, 2 * n);
            return r < n ? r : 2 * n - 1 - r;
        }
        case Wrap::clamp:
            return std::clamp<std::int64_t>(i, 0, n - 1);
        case Wrap::decal:
            break;
    }
    return i >= 0 && i < n ? i : -1;
}

bool tiles(Wrap wrap) { return wrap == Wrap::repeat || wrap == Wrap::mirror; }

}  // namespace

TexelCoverage::TexelCoverage(std::uint32_t width_px, std::uint32_t height_px)
    : width_(width_px), height_(height_px), used_(std::size_t{width_px} * height_px) {}

std::size_t TexelCoverage::count_used() const {
    return static_cast<std::size_t>(std::count(used_.begin(), used_.end(), true));
}

void TexelCoverage::mark_everything() {
    std::fill(used_.begin(), used_.end(), true);
    full_ = true;
}

/// Marks texels first..last of row y, unwrapped indices; false when there were none.
bool TexelCoverage::mark_row(std::int64_t y, std::int64_t first, std::int64_t last, Wrap wrap_u, Wrap wrap_v) {
    const std::int64_t row = wrapped(y, height_, wrap_v), w = width_;
    if (first > last || row < 0) return false;
    const auto texels = used_.begin() + row * w;
    const auto fill = [&](std::int64_t a, std::int64_t b) {
        if (a > b) return;
        std::fill(texels + a, texels + b + 1, true);
        marked_ += static_cast<std::size_t>(b - a + 1);
    };
    if (!tiles(wrap_u)) {
        if (wrap_u == Wrap::decal && (last < 0 || first >= w)) return false;
        fill(std::clamp<std::int64_t>(first, 0, w - 1), std::clamp<std::int64_t>(last, 0, w - 1));
    } else if (last - first + 1 >= 2 * w) {
        fill(0, w - 1);
    } else {
        for (std::int64_t tile = first; tile <= last;) {  // one stretch per tile
            const std::int64_t end = std::min(last, tile + (w - 1 - modulo(tile, w)));
            const std::int64_t a = wrapped(tile, w, wrap_u), b = wrapped(end, w, wrap_u);
            fill(std::min(a, b), std::max(a, b));
            tile = end + 1;
        }
    }
    return true;
}

void TexelCoverage::add(const std::array<Eigen::Vector2f, 3>& uv, Wrap wrap_u, Wrap wrap_v) {
    if (full_) return;
    // Triangles that lie over each other many times end here: either everything is used by now, or so much has been
    // marked that going on would cost more than the filling is worth.
    if (marked_ > used_.size()) {
        marked_total_ += marked_;
        marked_ = 0;
        if (count_used() == used_.size()) full_ = true;
        if (marked_total_ > (std::size_t{1} << 36)) mark_everything();
        if (full_) return;
    }
    const double w = width_, h = height_;
    std::array<Point, 3> p;
    for (int i = 0; i < 3; ++i) {
        const auto sane = [](float x) { return x > -4e6f && x < 4e6f ? double{x} : 0.0; };
        p[i] = {sane(uv[i].x()) * w, (1 - sane(uv[i].y())) * h};
    }
    double y_low = std::min({p[0].y(), p[1].y(), p[2].y()}), y_high = std::max({p[0].y(), p[1].y(), p[2].y()});
    if (tiles(wrap_v)) {
        if (y_high - y_low > 8 * h) return mark_everything();  // eight tiles high: nothing is left of the gutters
    } else {
        if (wrap_v == Wrap::clamp && (y_high < 0 || y_low >= h))  // all of it lies on the edge row
            for (Point& point : p) point.y() = y_high < 0 ? 0 : h - 0.5;
        y_low = std::clamp(std::min({p[0].y(), p[1].y(), p[2].y()}), -1.0, h);
        y_high = std::clamp(std::max({p[0].y(), p[1].y(), p[2].y()}), -1.0, h);
    }
    const auto first_row = static_cast<std::int64_t>(std::floor(y_low)),
               last_row = static_cast<std::int64_t>(std::floor(y_high));
    const auto index = [&](double x) { return static_cast<std::int64_t>(std::clamp(x, -1e15, 1e15)); };

    bool any = false;
    if (thickness(p) >= 1) {
        for (std::int64_t y = first_row; y <= last_row; ++y) {
            const double centre = static_cast<double>(y) + 0.5;
            const Interval x = extent_in_band(p, centre, centre);
            if (x.low <= x.high)
                any |= mark_row(y, index(std::ceil(x.low - 0.5)), index(std::floor(x.high - 0.5)), wrap_u, wrap_v);
        }
    }
    if (any) return;
    for (std::int64_t y = first_row; y <= last_row; ++y) {
        const Interval x = extent_in_band(p, static_cast<double>(y), static_cast<double>(y) + 1);
        if (x.low <= x.high) mark_row(y, index(std::floor(x.low)), index(std::floor(x.high)), wrap_u, wrap_v);
    }
}

}  // namespace voxtone::io

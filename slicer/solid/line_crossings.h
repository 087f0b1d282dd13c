// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the grid lines along one axis through voxel centres cross a triangle of a FixedMesh. Not for use outside the
// solid.
//
// The triangle is rasterised on the plane of the other two axes, u (inner) and w (outer), in exact integer arithmetic.
// Centres on the surface count as if moved by infinitesimals e along the line, e^2 along u and e^3 along w: one rule
// for every triangle, so a closed chain has no cracks.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "slicer/solid/fixed_mesh.h"

namespace voxtone::slicer {

struct LineWindow {
    std::int64_t u_begin, u_end, w_begin, w_end;
    /// Crossings farther than a voxel outside of this range along the line may be left out.
    double x_low = -std::numeric_limits<double>::infinity(), x_high = std::numeric_limits<double>::infinity();
};

/// Calls visit(u, w, c, x, step) for every line in the window that crosses the triangle: at x (in voxels, centres
/// whole), which is at or before centre c and behind centre c - 1 (decided exactly); step is the change of the winding
/// number there, +1 or -1. Corners are given as (along the line, u, w), axes right-handed.
template <class Visit>
void for_each_line_crossing(std::array<FixedMesh::Vertex, 3> v, int fraction_bits, const LineWindow& window,
                            Visit&& visit) {
    __extension__ typedef __int128 Int128;
    const int f = fraction_bits;
    const std::int64_t one = std::int64_t{1} << f;
    const double scale = 1.0 / double(one);

    const auto difference = [](std::int32_t a, std::int32_t b) { return std::int64_t{a} - b; };
    // Twice the area on the plane; positive where the surface faces along the line, so that the line leaves there.
    std::int64_t area = difference(v[1][1], v[0][1]) * difference(v[2][2], v[0][2]) -
                        difference(v[1][2], v[0][2]) * difference(v[2][1], v[0][1]);
    if (area == 0) return;
    const std::int32_t step = area > 0 ? -1 : 1;
    if (area < 0) {
        std::swap(v[1], v[2]);
        area = -area;
    }
    const auto [low, high] = std::minmax({v[0][2], v[1][2], v[2][2]});
    const std::int64_t w_first = std::max(ceil_div<std::int64_t>(low, one), window.w_begin);
    const std::int64_t w_last = std::min<std::int64_t>(high >> f, window.w_end - 1);
    const std::int64_t dx1 = difference(v[1][0], v[0][0]), dx2 = difference(v[2][0], v[0][0]);

    for (std::int64_t w = w_first; w <= w_last; ++w) {
        const std::int64_t at_w = w * one;
        // The inside of edge p -> q is e(u, w) = du (w - p_w) - dw (u - p_u) > 0, or = 0 where the infinitesimal step
        // makes it positive: dw < 0, or dw = 0 and du > 0.
        std::int64_t u_first = window.u_begin, u_end = window.u_end;
        for (int c = 0; c < 3; ++c) {
            const FixedMesh::Vertex &p = v[c], &q = v[(c + 1) % 3];
            const std::int64_t du = difference(q[1], p[1]), dw = difference(q[2], p[2]);
            const std::int64_t along = du * (at_w - p[2]);
            if (dw == 0) {
                if (along < 0 || (along == 0 && du <= 0)) u_end = u_first;
            } else if (dw < 0) {
                u_first = std::max(u_first, ceil_div(-(along + dw * p[1]), -dw * one));
            } else {
                u_end = std::min(u_end, ceil_div(along + dw * p[1], dw * one));
            }
        }
        if (u_first >= u_end) continue;
        if (std::isfinite(window.x_low)) {
            // x is linear along the row; a margin of two voxels covers the rounding.
            const double slope = (-double(difference(v[0][2], v[2][2])) * double(dx1) -
                                  double(difference(v[1][2], v[0][2])) * double(dx2)) /
                                 double(area);
            const auto weight = [&](const FixedMesh::Vertex& p, const FixedMesh::Vertex& q) {
                return double(difference(q[1], p[1])) * double(at_w - p[2]) +
                       double(difference(q[2], p[2])) * double(p[1]);
            };
            const double x_at_0 =
                (double(v[0][0]) +
                 (weight(v[2], v[0]) * double(dx1) + weight(v[0], v[1]) * double(dx2)) / double(area)) *
                scale;
            double from = -1e18, to = 1e18;
            if (std::abs(slope) > 1e-6) {
                const double a = (window.x_low - 1 - x_at_0) / slope, b = (window.x_high + 1 - x_at_0) / slope;
                from = std::min(a, b) - 2;
                to = std::max(a, b) + 2;
            }
            u_first = std::max(u_first, std::int64_t(std::clamp(from, double(u_first), double(u_end))));
            u_end = std::min(u_end, std::int64_t(std::clamp(std::ceil(to), double(u_first), double(u_end))));
            if (u_first >= u_end) continue;
        }

        // Barycentric weights of v1 and v2 times `area` are the edge functions of the edges opposite to them.
        const auto edge = [&](const FixedMesh::Vertex& p, const FixedMesh::Vertex& q) {
            return difference(q[1], p[1]) * (at_w - p[2]) - difference(q[2], p[2]) * (u_first * one - p[1]);
        };
        std::int64_t w1 = edge(v[2], v[0]), w2 = edge(v[0], v[1]);
        const std::int64_t w1_step = -(difference(v[0][2], v[2][2]) * one),
                           w2_step = -(difference(v[1][2], v[0][2]) * one);
        for (std::int64_t u = u_first; u < u_end; ++u, w1 += w1_step, w2 += w2_step) {
            const double x =
                (double(v[0][0]) + (double(w1) * double(dx1) + double(w2) * double(dx2)) / double(area)) * scale;
            const double up = std::ceil(x);
            // The double is off by less than 1e-8 voxel; nearer than that to a centre the integers decide.
            std::int64_t c;
            if (up - x > 1e-8 && x - (up - 1) > 1e-8)
                c = static_cast<std::int64_t>(up);
            else
                c = static_cast<std::int64_t>(
                    ceil_div<Int128>(Int128(v[0][0]) * area + Int128(w1) * dx1 + Int128(w2) * dx2, Int128(area) << f));
            visit(u, w, c, x, step);
        }
    }
}

}  // namespace voxtone::slicer

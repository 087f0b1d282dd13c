// SPDX-License-Identifier: GPL-3.0-or-later
//
// Closed surfaces for tests, oriented outward.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include <Eigen/Geometry>

#include "slicer/mesh/solid_mesh.h"

namespace shapes {

using Eigen::Vector3d;
using voxtone::slicer::SolidMesh;

inline SolidMesh with_sources(SolidMesh mesh) {
    mesh.source_triangle.resize(mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) mesh.source_triangle[t] = static_cast<std::int32_t>(t);
    return mesh;
}

inline SolidMesh box(const Vector3d& low, const Vector3d& high) {
    SolidMesh m;
    for (int c = 0; c < 8; ++c)
        m.positions_mm.emplace_back(c & 1 ? high[0] : low[0], c & 2 ? high[1] : low[1], c & 4 ? high[2] : low[2]);
    m.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return with_sources(m);
}

/// A grid of nu x nv points, closed in v always and in u for a torus; a sphere has poles.
inline SolidMesh torus(double major, double minor, int nu, int nv) {
    SolidMesh m;
    for (int u = 0; u < nu; ++u)
        for (int v = 0; v < nv; ++v) {
            const double a = 2 * std::numbers::pi * u / nu, b = 2 * std::numbers::pi * v / nv;
            const double r = major + minor * std::cos(b);
            m.positions_mm.emplace_back(r * std::cos(a), r * std::sin(a), minor * std::sin(b));
        }
    const auto at = [&](int u, int v) { return std::uint32_t((u % nu) * nv + v % nv); };
    for (int u = 0; u < nu; ++u)
        for (int v = 0; v < nv; ++v) {
            m.triangles.push_back({at(u, v), at(u + 1, v), at(u + 1, v + 1)});
            m.triangles.push_back({at(u, v), at(u + 1, v + 1), at(u, v + 1)});
        }
    return with_sources(m);
}

inline SolidMesh sphere(double radius, int n) {
    SolidMesh m;
    m.positions_mm.emplace_back(0, 0, -radius);
    for (int u = 1; u < n; ++u)
        for (int v = 0; v < 2 * n; ++v) {
            const double a = std::numbers::pi * u / n, b = std::numbers::pi * v / n;
            m.positions_mm.emplace_back(radius * std::sin(a) * std::cos(b), radius * std::sin(a) * std::sin(b),
                                        -radius * std::cos(a));
        }
    m.positions_mm.emplace_back(0, 0, radius);
    const auto top = std::uint32_t(m.positions_mm.size() - 1);
    const auto at = [&](int u, int v) { return std::uint32_t(1 + (u - 1) * 2 * n + v % (2 * n)); };
    for (int v = 0; v < 2 * n; ++v) {
        m.triangles.push_back({0, at(1, v + 1), at(1, v)});
        for (int u = 1; u + 1 < n; ++u) {
            m.triangles.push_back({at(u, v), at(u, v + 1), at(u + 1, v + 1)});
            m.triangles.push_back({at(u, v), at(u + 1, v + 1), at(u + 1, v)});
        }
        m.triangles.push_back({at(n - 1, v), at(n - 1, v + 1), top});
    }
    return with_sources(m);
}

inline SolidMesh flipped(SolidMesh m) {
    for (auto& t : m.triangles) std::swap(t[1], t[2]);
    return m;
}

inline SolidMesh joined(SolidMesh a, const SolidMesh& b) {
    const auto offset = static_cast<std::uint32_t>(a.positions_mm.size());
    a.positions_mm.insert(a.positions_mm.end(), b.positions_mm.begin(), b.positions_mm.end());
    for (const auto& t : b.triangles) a.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
    return with_sources(a);
}

inline SolidMesh moved(SolidMesh m, const Eigen::Affine3d& by) {
    for (auto& p : m.positions_mm) p = by * p;
    return m;
}

inline SolidMesh moved(SolidMesh m, const Vector3d& by) {
    return moved(std::move(m), Eigen::Affine3d(Eigen::Translation3d(by)));
}

inline Eigen::Affine3d tilt() {
    return Eigen::Affine3d(Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()) *
                           Eigen::AngleAxisd(-1.1, Vector3d(3, -1, 1).normalized()));
}

inline double volume(const SolidMesh& m) {
    double v = 0;
    for (const auto& t : m.triangles)
        v += m.positions_mm[t[0]].dot(m.positions_mm[t[1]].cross(m.positions_mm[t[2]])) / 6;
    return v;
}

/// Area and outline length of the cut at height z, by Green's theorem over the cut segments.
struct Cut {
    double area = 0, outline = 0;
};
inline Cut cut(const SolidMesh& m, double z) {
    Cut result;
    for (const auto& t : m.triangles) {
        Vector3d ends[2];
        int n = 0;
        bool first_rises = false;
        for (int c = 0; c < 3; ++c) {
            const Vector3d &p = m.positions_mm[t[c]], &q = m.positions_mm[t[(c + 1) % 3]];
            if ((p[2] <= z) == (q[2] <= z)) continue;
            if (n == 0) first_rises = q[2] > z;
            ends[n++] = p + (q - p) * ((z - p[2]) / (q[2] - p[2]));
        }
        if (n != 2) continue;
        if (first_rises) std::swap(ends[0], ends[1]);  // inside on the left
        result.area += 0.5 * (ends[0][0] * ends[1][1] - ends[0][1] * ends[1][0]);
        result.outline += (ends[1] - ends[0]).norm();
    }
    return result;
}

/// Winding number at a point off the surface: the sum of solid angles (A. van Oosterom, J. Strackee, 1983).
inline int winding_number(const SolidMesh& m, const Vector3d& p) {
    long double sum = 0;
    for (const auto& t : m.triangles) {
        // A triangle without area spans no angle; the formula would see noise where the point lies beside it.
        const Vector3d &a = m.positions_mm[t[0]], &b = m.positions_mm[t[1]], &c = m.positions_mm[t[2]];
        if ((b - a).cross(c - a).isZero(0)) continue;
        Eigen::Matrix<long double, 3, 1> r[3];
        long double length[3];
        for (int n = 0; n < 3; ++n) {
            r[n] = (m.positions_mm[t[n]] - p).cast<long double>();
            length[n] = r[n].norm();
        }
        sum +=
            2 * std::atan2(r[0].dot(r[1].cross(r[2])), length[0] * length[1] * length[2] + r[0].dot(r[1]) * length[2] +
                                                           r[1].dot(r[2]) * length[0] + r[2].dot(r[0]) * length[1]);
    }
    return static_cast<int>(std::lround(sum / (4 * std::numbers::pi_v<long double>)));
}

}  // namespace shapes

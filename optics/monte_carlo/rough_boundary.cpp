// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/monte_carlo/rough_boundary.h"

#include <algorithm>
#include <cmath>

#include "optics/monte_carlo/rough_interface.h"

namespace voxtone::optics {
namespace {

/// Two directions across n (Duff et al. 2017, "Building an orthonormal basis, revisited").
struct Frame {
    explicit Frame(const Point& normal) : n(normal) {
        const double s = std::copysign(1.0, n[2]), k = -1 / (s + n[2]), m = n[0] * n[1] * k;
        u = {1 + s * n[0] * n[0] * k, s * m, -s * n[0]};
        v = {m, s + n[1] * n[1] * k, -n[1]};
    }
    [[nodiscard]] Point local(const Point& d) const { return {dot(d, u), dot(d, v), dot(d, n)}; }
    [[nodiscard]] Point world(const Point& d) const {
        Point out{};
        for (std::size_t a = 0; a < 3; ++a) out[a] = d[0] * u[a] + d[1] * v[a] + d[2] * n[a];
        const double length = std::sqrt(dot(out, out));
        for (double& x : out) x /= length;
        return out;
    }
    Point u{}, v{}, n;
};

}  // namespace

bool cross_boundary(const BoundaryNormals& normals, double eta, double roughness, bool inside, Point& direction,
                    PathRandom& random) {
    const double out = inside ? 1.0 : -1.0;  // which way the ray comes along the outward normal
    const double from = inside ? eta : 1.0, to = inside ? 1.0 : eta;
    const auto about = [&](const Point& n, Point& d) {
        const Frame frame(n);
        std::array<double, 3> local = frame.local(direction);
        // Along the surface at most, where a triangle is met from its edge.
        if (out * local[2] <= 0) local[2] = out * 1e-9;
        const bool through = cross_interface(local, from, to, roughness, random);
        d = frame.world(local);
        return through;
    };
    if (out * dot(direction, normals.shading) > 0) {
        Point d{};
        const bool through = about(normals.shading, d);
        if (out * dot(d, normals.geometric) * (through ? 1 : -1) > 0) {
            direction = d;
            return through;
        }
    }
    return about(normals.geometric, direction);
}

}  // namespace voxtone::optics

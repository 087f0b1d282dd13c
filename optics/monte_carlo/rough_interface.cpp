// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/monte_carlo/rough_interface.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "optics/scene/fresnel.h"
#include "optics/scene/point.h"

namespace voxtone::optics {
namespace {

using Direction = std::array<double, 3>;

constexpr int most_facets = 64;  // met before the ray is let go as from a smooth surface; rays of 1e8 never did

Direction reversed(const Direction& d) { return {-d[0], -d[1], -d[2]}; }

// Smith's Lambda of GGX for a direction w, +z away from the surface.
double smith_lambda(const Direction& w, double alpha) {
    const double sine2 = std::max(0.0, 1 - w[2] * w[2]), a2 = w[2] * w[2] / std::max(alpha * alpha * sine2, 1e-300);
    const double root = std::sqrt(1 + 1 / a2);
    return 0.5 * (w[2] > 0 ? root - 1 : -root - 1);
}

// Where a ray that leaves height (as a share of lower surface) along w meets the surface next; nothing: it is free.
std::optional<double> next_height(const Direction& w, double height, double alpha, PathRandom& random) {
    const double u = random.uniform();
    if (w[2] > 0.9999) return std::nullopt;
    if (w[2] < -0.9999) return u * height;
    if (std::abs(w[2]) < 1e-4) return height;
    const double lambda = smith_lambda(w, alpha);
    if (w[2] > 0 && u > 1 - std::pow(height, lambda)) return std::nullopt;
    return std::clamp(height * std::pow(1 - u, -1 / lambda), 0.0, 1.0);
}

// A facet that is seen from v, by its normal.
Direction visible_facet(const Direction& v, double alpha, PathRandom& random) {
    Direction stretched{alpha * v[0], alpha * v[1], v[2]};
    const double length = std::sqrt(dot(stretched, stretched));
    for (double& x : stretched) x /= length;
    const double across = std::hypot(stretched[0], stretched[1]);
    const Direction t1 =
        across > 1e-9 ? Direction{-stretched[1] / across, stretched[0] / across, 0.0} : Direction{1, 0, 0};
    const Direction t2{stretched[1] * t1[2] - stretched[2] * t1[1], stretched[2] * t1[0] - stretched[0] * t1[2],
                       stretched[0] * t1[1] - stretched[1] * t1[0]};
    const double r = std::sqrt(random.uniform()), phi = 2 * std::numbers::pi * random.uniform();
    const double p1 = r * std::cos(phi), s = 0.5 * (1 + stretched[2]);
    const double p2 = (1 - s) * std::sqrt(std::max(0.0, 1 - p1 * p1)) + s * r * std::sin(phi);
    const double p3 = std::sqrt(std::max(0.0, 1 - p1 * p1 - p2 * p2));
    Direction n{};
    for (std::size_t a = 0; a < 3; ++a) n[a] = p1 * t1[a] + p2 * t2[a] + p3 * stretched[a];
    n = {alpha * n[0], alpha * n[1], std::max(1e-9, n[2])};
    const double norm = std::sqrt(dot(n, n));
    for (double& x : n) x /= norm;
    return n;
}

// d meets a facet of normal n, d.n < 0: mirrored, or refracted where `through`.
Direction beyond_facet(const Direction& d, const Direction& n, double ratio, bool through) {
    const double cosine = -dot(d, n);
    Direction out{};
    if (!through) {
        for (std::size_t a = 0; a < 3; ++a) out[a] = d[a] + 2 * cosine * n[a];
        return out;
    }
    const double inside = std::sqrt(std::max(0.0, 1 - (1 - cosine * cosine) / (ratio * ratio)));
    for (std::size_t a = 0; a < 3; ++a) out[a] = d[a] / ratio + (cosine / ratio - inside) * n[a];
    const double norm = std::sqrt(dot(out, out));
    for (double& x : out) x /= norm;
    return out;
}

bool cross_smooth(Direction& d, double eta_from, double eta_to, PathRandom& random) {
    const double cosine = std::abs(d[2]);
    const double F = interface_reflectance(cosine, eta_from, eta_to);
    if (F >= 1 || random.uniform() < F) {
        d[2] = -d[2];
        return false;
    }
    const double ratio = eta_to / eta_from;
    d[0] /= ratio;
    d[1] /= ratio;
    d[2] = std::copysign(std::sqrt(std::max(0.0, 1 - d[0] * d[0] - d[1] * d[1])), d[2]);
    return true;
}

}  // namespace

double interface_reflectance(double cosine, double eta_from, double eta_to) {
    if (eta_to >= eta_from) return fresnel_reflectance(std::max(cosine, 1e-12), eta_to / eta_from);
    const double ratio = eta_from / eta_to, sine2 = (1 - cosine * cosine) * ratio * ratio;
    return sine2 >= 1 ? 1.0 : fresnel_reflectance(std::max(std::sqrt(1 - sine2), 1e-12), ratio);
}

bool cross_interface(Direction& d, double eta_from, double eta_to, double roughness, PathRandom& random) {
    if (eta_from == eta_to) return true;
    if (roughness <= 0) return cross_smooth(d, eta_from, eta_to, random);
    // Seen with the ray coming down from outside; `up` turns directions into that frame and back.
    const double up = d[2] > 0 ? -1 : 1;
    Direction w{d[0], d[1], d[2] * up};
    bool outside = true;
    double height = 1;  // share of the surface that lies lower
    for (int facet = 0; facet < most_facets; ++facet) {
        const Direction along = outside ? w : reversed(w);
        const std::optional<double> next = next_height(along, outside ? height : 1 - height, roughness, random);
        if (!next) {
            d = {w[0], w[1], w[2] * up};
            return !outside;
        }
        height = outside ? *next : 1 - *next;
        const Direction v = reversed(along), n = visible_facet(v, roughness, random);
        const Direction normal = outside ? n : reversed(n);
        const double cosine = std::min(-dot(w, normal), 1.0);
        if (cosine <= 0) continue;
        const double from = outside ? eta_from : eta_to, to = outside ? eta_to : eta_from;
        const double F = interface_reflectance(cosine, from, to);
        const bool through = F < 1 && random.uniform() >= F;
        w = beyond_facet(w, normal, to / from, through);
        outside = outside != through;
    }
    return cross_smooth(d, eta_from, eta_to, random);
}

}  // namespace voxtone::optics

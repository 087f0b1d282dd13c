// SPDX-License-Identifier: GPL-3.0-or-later
//
// A body that was never made, and photographs of it whose every ray is met in closed form: an ellipsoid with an ear, in
// a pattern, under a lamp and a sky that mirrors in it.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/Geometry>

#include "base/random.h"
#include "calibration/compare/predicted_body.h"
#include "io/pictures/photograph.h"
#include "optics/camera/camera.h"
#include "optics/scene/fresnel.h"

namespace voxtone::calibration::testing {

struct Ellipsoid {
    Eigen::Vector3d middle, radii;
};
inline const std::array<Ellipsoid, 2>& ellipsoids() {
    static const std::array<Ellipsoid, 2> both{Ellipsoid{{0, 0, 0}, {4.5, 3.5, 5.5}},
                                               Ellipsoid{{3.4, -0.8, 4.2}, {1.8, 1.4, 2.2}}};
    return both;
}

/// Discs of many colours with soft rims, and broad waves.
inline Eigen::Vector3d pattern_at(const Eigen::Vector3d& p, std::uint64_t seed = 1) {
    Eigen::Vector3d rgb(0.6 + 0.15 * std::sin(0.7 * p.x() + double(seed)), 0.55 + 0.15 * std::sin(0.9 * p.z()),
                        0.5 + 0.2 * std::sin(0.8 * p.y() + 0.5 * p.z()));
    RandomStream random(seed, 0);
    for (int disc = 0; disc < 60; ++disc) {
        const double z = 2 * random.uniform() - 1, turn = 2 * std::numbers::pi * random.uniform();
        const double across = std::sqrt(1 - z * z), radius = 0.4 + 1.2 * random.uniform();
        const Eigen::Vector3d at(4.5 * across * std::cos(turn), 3.5 * across * std::sin(turn), 5.5 * z);
        const double red = random.uniform(), green = random.uniform(), blue = random.uniform();
        const double share = 0.5 - 0.5 * std::tanh(((p - at).norm() - radius) / 0.15);
        rgb += share * (Eigen::Vector3d(0.05 + 0.8 * red, 0.05 + 0.8 * green, 0.05 + 0.8 * blue) - rgb);
    }
    return rgb;
}

struct BodyHit {
    Eigen::Vector3d at, normal;
};
inline std::optional<BodyHit> hit(const Eigen::Vector3d& from, const Eigen::Vector3d& way) {
    std::optional<BodyHit> nearest;
    double first = 1e30;
    for (const Ellipsoid& e : ellipsoids()) {
        const Eigen::Vector3d o = (from - e.middle).cwiseQuotient(e.radii), d = way.cwiseQuotient(e.radii);
        const double a = d.dot(d), b = o.dot(d), root = b * b - a * (o.dot(o) - 1);
        if (root < 0) continue;
        const double t = (-b - std::sqrt(root)) / a;
        if (t <= 1e-9 || t >= first) continue;
        first = t;
        const Eigen::Vector3d at = from + t * way;
        nearest = BodyHit{at, (at - e.middle).cwiseQuotient(e.radii.cwiseProduct(e.radii)).normalized()};
    }
    return nearest;
}

/// From a side: as `proof` names them, from the front or the back.
inline optics::CameraView side_view(double azimuth_deg, double height_deg, int width_px, int height_px) {
    const double a = azimuth_deg * std::numbers::pi / 180, h = height_deg * std::numbers::pi / 180;
    return {.position = {60 * std::cos(h) * std::cos(a), 60 * std::cos(h) * std::sin(a), 60 * std::sin(h)},
            .width_px = width_px,
            .height_px = height_px};
}

/// As it is predicted: a place each 0.2 mm.
inline PredictedBody eared_body(std::uint64_t seed = 1) {
    PredictedBody body;
    body.name = "out/eared", body.model = "transport";
    body.cell_mm = 0.2;
    body.set.eta = 1.5;
    for (const Ellipsoid& e : ellipsoids()) {
        const int rows = int(std::numbers::pi * e.radii.maxCoeff() / body.cell_mm), columns = 2 * rows;
        const auto first = std::uint32_t(body.position.size());
        for (int j = 0; j <= rows; ++j)
            for (int i = 0; i < columns; ++i) {
                const double t = std::numbers::pi * j / rows, f = 2 * std::numbers::pi * i / columns;
                const Eigen::Vector3d out(std::sin(t) * std::cos(f), std::sin(t) * std::sin(f), std::cos(t));
                const Eigen::Vector3d at = e.middle + e.radii.cwiseProduct(out);
                body.position.push_back(at.cast<float>());
                body.normal.push_back(out.cwiseQuotient(e.radii).normalized().cast<float>());
                body.rgb.push_back(pattern_at(at, seed).cast<float>());
            }
        for (int j = 0; j < rows; ++j)
            for (int i = 0; i < columns; ++i) {
                const auto at = [&](int row, int column) {
                    return first + std::uint32_t(row * columns + column % columns);
                };
                body.triangles.push_back({at(j, i), at(j + 1, i), at(j + 1, i + 1)});
                body.triangles.push_back({at(j, i), at(j + 1, i + 1), at(j, i + 1)});
            }
    }
    body.start = [](int w, int h) { return side_view(-90, 9, w, h); };
    body.other_sides = {{"front", body.start}, {"back", [](int w, int h) { return side_view(90, 9, w, h); }}};
    body.sees_sky = [position = body.position, normal = body.normal](std::span<const std::uint32_t> places,
                                                                     std::span<const Eigen::Vector3d> ways) {
        std::vector<std::uint8_t> sees;
        for (const std::uint32_t place : places)
            for (const Eigen::Vector3d& way : ways) {
                const Eigen::Vector3d n = normal[place].cast<double>();
                sees.push_back(n.dot(way) > 0 && !hit(position[place].cast<double>() + 0.05 * n, way));
            }
        return sees;
    };
    body.eye = [](int, int, const Eigen::Vector2d&) {
        return
            [](std::span<const Eigen::Vector3f> rgb) { return std::vector<Eigen::Vector3f>(rgb.begin(), rgb.end()); };
    };
    return body;
}

struct BodyPhoto {
    optics::CameraView view;
    double gloss = 1;                       ///< of a smooth surface's
    Eigen::Vector3d gain{0.75, 0.8, 0.65};  ///< exposure and white balance
    double noise = 0.004;
    std::uint64_t pattern = 1;
};

inline io::Photograph photo_of(const BodyPhoto& o) {
    constexpr int rays = 3;
    const optics::Camera camera(o.view);
    const Eigen::Vector3d from(o.view.position[0], o.view.position[1], o.view.position[2]),
        lamp = Eigen::Vector3d(-0.6, -0.5, 0.7).normalized();
    io::Photograph photo{.name = "body.png",
                         .width_px = std::uint32_t(o.view.width_px),
                         .height_px = std::uint32_t(o.view.height_px),
                         .pixels = {}};
    RandomStream random(5, 0);
    for (int y = 0; y < o.view.height_px; ++y)
        for (int x = 0; x < o.view.width_px; ++x) {
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
            for (int s = 0; s < rays * rays; ++s) {
                const optics::Point d = camera.direction(x + (s % rays + 0.5) / rays, y + (s / rays + 0.5) / rays);
                const Eigen::Vector3d way(d[0], d[1], d[2]);
                const std::optional<BodyHit> met = hit(from, way);
                if (!met) {
                    sum += Eigen::Vector3d::Constant(0.16 + 0.02 * y / o.view.height_px);
                    continue;
                }
                const double on = 0.6 + 0.25 * met->normal.z() + 0.4 * std::max(0.0, met->normal.dot(lamp)),
                             cosine = -way.dot(met->normal), F = optics::fresnel_reflectance(cosine, 1.5),
                             T = (1 - F) / (1 - optics::fresnel_reflectance(1, 1.5));
                const double up = (way + 2 * cosine * met->normal).z();  // where it mirrors
                sum +=
                    T * on * pattern_at(met->at, o.pattern) + Eigen::Vector3d::Constant(o.gloss * F * (0.6 + 0.3 * up));
            }
            Eigen::Vector3f rgb = o.gain.cwiseProduct(sum / (rays * rays)).cast<float>();
            for (int c = 0; c < 3; ++c) {
                const double u = 1 - random.uniform(), v = random.uniform();
                rgb[c] += float(o.noise * std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v));
            }
            photo.pixels.push_back(rgb.cwiseMax(0.0f).cwiseMin(1.0f));
        }
    return photo;
}

/// Aside of the front by some ten degrees, not aimed at the middle, with another lens.
inline BodyPhoto hand_photo() {
    BodyPhoto o;
    o.view = side_view(-81, 15, 480, 360);
    o.view.target = {0.7, 0.3, -0.4};
    o.view.up = {0.08, 0, 1};
    o.view.focal_mm = 80;
    return o;
}

}  // namespace voxtone::calibration::testing

// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/halftone/loop/residual_feedback.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include <Eigen/Cholesky>

#include "voxtone/base/contracts.h"
#include "voxtone/base/parallel.h"
#include "voxtone/optics/colour/colour.h"

namespace voxtone::halftone {

namespace {

Eigen::Vector3f root(const Eigen::Vector3f& rgb) {
    return {std::cbrt(std::max(rgb.x(), 0.0f)), std::cbrt(std::max(rgb.y(), 0.0f)), std::cbrt(std::max(rgb.z(), 0.0f))};
}

Eigen::Vector3f cube(const Eigen::Vector3f& v) { return v.array().cube().matrix(); }

/// The drive after a step, and which channels could not follow.
struct Step {
    Eigen::Vector3f drive;
    std::array<bool, 3> stuck{};
    [[nodiscard]] bool any() const { return stuck[0] || stuck[1] || stuck[2]; }
};

Step step(const Eigen::Vector3f& drive, const Eigen::Vector3f& residual,
          const std::function<Eigen::Vector3f(const Eigen::Vector3f&)>& into_gamut, const FeedbackOptions& options) {
    constexpr float least = 0.01f;  // of a cube root: smaller residuals are not called stuck
    Step s;
    const Eigen::Vector3f before = root(drive);
    const Eigen::Vector3f wanted = (options.gain * residual).cwiseMax(-options.most_step).cwiseMin(options.most_step);
    s.drive = into_gamut(cube((before + wanted).cwiseMax(0.0f).cwiseMin(1.0f)));
    const Eigen::Vector3f moved = root(s.drive) - before;
    for (Eigen::Index c = 0; c < 3; ++c)
        s.stuck[static_cast<std::size_t>(c)] =
            std::abs(wanted[c]) > least && moved[c] * wanted[c] < 0.5f * wanted[c] * wanted[c];
    return s;
}

}  // namespace

Eigen::Vector3f nearest_colour(const Eigen::Vector3f& target, const Eigen::Vector3f& from,
                               const std::array<bool, 3>& stuck) {
    constexpr double least = 1e-4;  // keeps the slope of Oklab finite
    const Eigen::Vector3d wanted = optics::oklab_from_linear_srgb(target.cast<double>());
    const Eigen::Vector3d weight(1, 2, 2);
    Eigen::Vector3d v;
    for (Eigen::Index c = 0; c < 3; ++c)
        v[c] = std::clamp<double>(stuck[static_cast<std::size_t>(c)] ? from[c] : target[c], least, 1.0);
    const auto cost = [&](const Eigen::Vector3d& rgb) {
        return weight.cwiseProduct(optics::oklab_from_linear_srgb(rgb) - wanted).squaredNorm();
    };
    double now = cost(v), damping = 1e-3;
    // Gauss-Newton in the cube roots of the free channels, which are about as straight as Oklab in them.
    for (int iteration = 0; iteration < 12 && damping < 1e3; ++iteration) {
        const Eigen::Vector3d slope = 3 * v.array().pow(2.0 / 3).matrix();
        Eigen::Matrix3d J = weight.asDiagonal() * optics::oklab_derivative(v) * slope.asDiagonal();
        for (Eigen::Index c = 0; c < 3; ++c)
            if (stuck[static_cast<std::size_t>(c)]) J.col(c).setZero();
        const Eigen::Vector3d residual = weight.cwiseProduct(optics::oklab_from_linear_srgb(v) - wanted);
        Eigen::Matrix3d normal = J.transpose() * J;
        for (Eigen::Index c = 0; c < 3; ++c)
            normal(c, c) += damping * (normal(c, c) + 1e-6) + (stuck[static_cast<std::size_t>(c)] ? 1 : 0);
        const Eigen::Vector3d change = normal.ldlt().solve(-(J.transpose() * residual));
        Eigen::Vector3d next = v;
        for (Eigen::Index c = 0; c < 3; ++c)
            if (!stuck[static_cast<std::size_t>(c)]) {
                const double r = std::clamp(std::cbrt(v[c]) + change[c], std::cbrt(least), 1.0);
                next[c] = r * r * r;
            }
        const double then = cost(next);
        if (!(then < now)) {
            damping *= 10;
            continue;
        }
        const bool done = now - then < 1e-7;
        v = next;
        now = then;
        damping = std::max(damping / 10, 1e-6);
        if (done) break;
    }
    return v.cast<float>();
}

std::size_t feed_back(std::span<const Eigen::Vector3f> target, std::span<const Eigen::Vector3f> predicted,
                      const std::function<Eigen::Vector3f(const Eigen::Vector3f&)>& into_gamut,
                      const FeedbackOptions& options, std::span<Eigen::Vector3f> drive,
                      std::span<Eigen::Vector3f> eased) {
    VOXTONE_EXPECT(predicted.size() == target.size() && drive.size() == target.size() && eased.size() == target.size());
    std::atomic<std::size_t> stuck_cells{0};
    parallel_ranges(0, target.size(), 256, [&](std::size_t first, std::size_t last) {
        std::size_t stuck = 0;
        for (std::size_t i = first; i < last; ++i) {
            const Eigen::Vector3f seen = root(predicted[i]);
            eased[i] = target[i];
            Step moved = step(drive[i], root(target[i]) - seen, into_gamut, options);
            if (moved.any()) {
                ++stuck;
                if (!(moved.stuck[0] && moved.stuck[1] && moved.stuck[2])) {
                    eased[i] = nearest_colour(target[i], predicted[i], moved.stuck);
                    moved = step(drive[i], root(eased[i]) - seen, into_gamut, options);
                } else {
                    eased[i] = predicted[i];
                }
            }
            drive[i] = moved.drive;
        }
        stuck_cells += stuck;
    });
    return stuck_cells;
}

}  // namespace voxtone::halftone

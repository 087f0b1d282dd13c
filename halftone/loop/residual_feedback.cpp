// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/loop/residual_feedback.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include <Eigen/Cholesky>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/colour/colour.h"
#include "optics/numerics/portable_math.h"

namespace voxtone::halftone {

namespace {

Eigen::Vector3f root(const Eigen::Vector3f& rgb) {
    return {portable::cbrt(std::max(rgb.x(), 0.0f)), portable::cbrt(std::max(rgb.y(), 0.0f)),
            portable::cbrt(std::max(rgb.z(), 0.0f))};
}

Eigen::Vector3f cube(const Eigen::Vector3f& v) { return v.array().cube().matrix(); }

/// The control colour after a step, which channels could not follow, and by how much.
struct Step {
    Eigen::Vector3f control, missed;
    std::array<bool, 3> saturated{};
};

Step step(const Eigen::Vector3f& control, const Eigen::Vector3f& residual,
          const std::function<Eigen::Vector3f(const Eigen::Vector3f&)>& into_gamut, const FeedbackOptions& options) {
    constexpr float least = 0.01f;  // of a cube root: smaller residuals are not called saturated
    Step s;
    const Eigen::Vector3f before = root(control);
    const Eigen::Vector3f wanted = (options.gain * residual).cwiseMax(-options.most_step).cwiseMin(options.most_step);
    s.control = into_gamut(cube((before + wanted).cwiseMax(0.0f).cwiseMin(1.0f)));
    const Eigen::Vector3f moved = root(s.control) - before;
    s.missed = (wanted - moved).cwiseAbs();
    for (Eigen::Index c = 0; c < 3; ++c)
        s.saturated[static_cast<std::size_t>(c)] =
            std::abs(wanted[c]) > least && moved[c] * wanted[c] < 0.5f * wanted[c] * wanted[c];
    return s;
}

}  // namespace

Eigen::Vector3f nearest_colour(const Eigen::Vector3f& target, const Eigen::Vector3f& from,
                               const std::array<bool, 3>& saturated) {
    constexpr double least = 1e-4;  // the cube root has a slope
    const Eigen::Vector3d lab = optics::lab_from_linear_srgb(target.cast<double>());
    Eigen::Vector3d v;
    for (Eigen::Index c = 0; c < 3; ++c)
        v[c] = std::clamp<double>(saturated[static_cast<std::size_t>(c)] ? from[c] : target[c], least, 1.0);
    Eigen::Matrix3d W;
    const auto off = [&](const Eigen::Vector3d& rgb) -> Eigen::Vector3d {
        const Eigen::Vector3d there = optics::lab_from_linear_srgb(rgb);
        W = optics::ciede2000_metric(0.5 * (lab + there));
        return W * (there - lab);
    };
    Eigen::Vector3d residual = off(v);
    double now = residual.squaredNorm(), damping = 1e-3;
    // Gauss-Newton in the cube roots of the free channels, in which Lab is about straight.
    for (int iteration = 0; iteration < 12 && damping < 1e3; ++iteration) {
        const Eigen::Vector3d slope = 3 * v.array().pow(2.0 / 3).matrix();
        Eigen::Matrix3d J = W * optics::lab_derivative(v) * slope.asDiagonal();
        for (Eigen::Index c = 0; c < 3; ++c)
            if (saturated[static_cast<std::size_t>(c)]) J.col(c).setZero();
        Eigen::Matrix3d normal = J.transpose() * J;
        for (Eigen::Index c = 0; c < 3; ++c)
            normal(c, c) += damping * (normal(c, c) + 1e-6) + (saturated[static_cast<std::size_t>(c)] ? 1 : 0);
        const Eigen::Vector3d change = normal.ldlt().solve(-(J.transpose() * residual));
        Eigen::Vector3d next = v;
        for (Eigen::Index c = 0; c < 3; ++c)
            if (!saturated[static_cast<std::size_t>(c)]) {
                const double r = std::clamp(portable::cbrt(v[c]) + change[c], portable::cbrt(least), 1.0);
                next[c] = r * r * r;
            }
        const Eigen::Vector3d residual_then = off(next);
        const double then = residual_then.squaredNorm();
        if (!(then < now)) {
            damping *= 10;
            continue;
        }
        const bool done = now - then < 1e-3;
        v = next;
        residual = residual_then;
        now = then;
        damping = std::max(damping / 10, 1e-6);
        if (done) break;
    }
    return v.cast<float>();
}

std::vector<Eigen::Vector3f> as_wrong_as_seen(std::span<const Eigen::Vector3f> target,
                                              std::span<const Eigen::Vector3f> seen_target,
                                              std::span<const Eigen::Vector3f> seen) {
    VOXTONE_EXPECT(seen_target.size() == target.size() && seen.size() == target.size());
    std::vector<Eigen::Vector3f> colours(target.size());
    parallel_for(0, target.size(), 1024, [&](std::size_t i) {
        colours[i] = cube((root(target[i]) - (root(seen_target[i]) - root(seen[i]))).cwiseMax(0.0f));
    });
    return colours;
}

namespace {

/// The step of one cell; `relaxed` becomes what it is asked for. The channel that misses most is given up first, and
/// the others asked for the colour that is nearest then: at the gamut's edge one channel's limit stops them all,
/// although they could go back.
Step relaxing_step(const Eigen::Vector3f& control, const Eigen::Vector3f& target, const Eigen::Vector3f& predicted,
                   const std::function<Eigen::Vector3f(const Eigen::Vector3f&)>& into_gamut,
                   const FeedbackOptions& options, Eigen::Vector3f& relaxed) {
    const Eigen::Vector3f seen = root(predicted);
    relaxed = target;
    Step moved = step(control, root(target) - seen, into_gamut, options);
    std::array<bool, 3> given_up{};
    for (int turn = 0; turn < 2; ++turn) {
        std::size_t most = 3;
        for (std::size_t c = 0; c < 3; ++c)
            if (moved.saturated[c] && !given_up[c] &&
                (most == 3 ||
                 moved.missed[static_cast<Eigen::Index>(c)] > moved.missed[static_cast<Eigen::Index>(most)]))
                most = c;
        if (most == 3) break;
        given_up[most] = true;
        relaxed = nearest_colour(target, predicted, given_up);
        moved = step(control, root(relaxed) - seen, into_gamut, options);
    }
    return moved;
}

}  // namespace

std::size_t feed_back(std::span<const Eigen::Vector3f> target, std::span<const Eigen::Vector3f> predicted,
                      const std::function<Eigen::Vector3f(const Eigen::Vector3f&)>& into_gamut,
                      const FeedbackOptions& options, std::span<Eigen::Vector3f> control,
                      std::span<Eigen::Vector3f> relaxed) {
    VOXTONE_EXPECT(predicted.size() == target.size() && control.size() == target.size() &&
                   relaxed.size() == target.size());
    std::atomic<std::size_t> relaxed_cells{0};
    parallel_ranges(0, target.size(), 256, [&](std::size_t first, std::size_t last) {
        std::size_t count = 0;
        for (std::size_t i = first; i < last; ++i) {
            control[i] = relaxing_step(control[i], target[i], predicted[i], into_gamut, options, relaxed[i]).control;
            count += relaxed[i] != target[i];
        }
        relaxed_cells += count;
    });
    return relaxed_cells;
}

}  // namespace voxtone::halftone

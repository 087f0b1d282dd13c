// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/compare/edge_blur.h"
#include "optics/numerics/median.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace voxtone::calibration {

namespace {

constexpr int profile_steps = 48;        // from outside to inside
constexpr double reach_px = 6;           // each way
constexpr double least_contrast = 0.05;  // between ground and print, of the brighter
constexpr int ends = 6;                  // steps whose mean is the level of each side

/// Where the profile passes `share` of the way between its ends, in steps, from outside.
std::optional<double> crossing(const std::vector<double>& profile, double share) {
    double outside = 0, inside = 0;
    for (int i = 0; i < ends; ++i) {
        outside += profile[std::size_t(i)] / ends;
        inside += profile[profile.size() - 1 - std::size_t(i)] / ends;
    }
    if (std::abs(inside - outside) < least_contrast * std::max(inside, outside)) return std::nullopt;
    const auto part = [&](std::size_t i) { return (profile[i] - outside) / (inside - outside); };
    for (std::size_t i = 1; i < profile.size(); ++i)
        if (part(i - 1) < share && part(i) >= share)
            return double(i - 1) + (share - part(i - 1)) / (part(i) - part(i - 1));
    return std::nullopt;
}

}  // namespace

std::optional<double> edge_blur_px(const io::Photograph& photo, const PrintPlace& place) {
    const Eigen::Vector2d s = place.size();
    const std::array<Eigen::Vector2d, 4> corner{Eigen::Vector2d(0, 0), Eigen::Vector2d(s.x(), 0), s,
                                                Eigen::Vector2d(0, s.y())};
    std::vector<double> each;
    for (std::size_t side = 0; side < 4; ++side) {
        constexpr int lines = 120;
        for (int line = 0; line < lines; ++line) {
            const double t = 0.1 + 0.8 * (line + 0.5) / lines;
            const Eigen::Vector2d along = corner[(side + 1) % 4] - corner[side], at = corner[side] + t * along;
            const Eigen::Vector2d px = place.to_px(at), way = place.to_px(at + 0.5 * along.normalized()) - px;
            const Eigen::Vector2d inward = Eigen::Vector2d(-way.y(), way.x()).normalized();
            std::vector<double> profile;
            for (int i = 0; i <= profile_steps; ++i)
                profile.push_back(
                    double(sample_at(photo, px + inward * reach_px * (2.0 * i / profile_steps - 1)).sum()));
            const auto first = crossing(profile, 0.25), last = crossing(profile, 0.75);
            if (first && last && *last > *first)
                each.push_back((*last - *first) * 2 * reach_px / profile_steps / 1.349);
        }
    }
    constexpr std::size_t least_lines = 100;  // of 480
    if (each.size() < least_lines) return std::nullopt;
    return optics::median(std::move(each));
}

}  // namespace voxtone::calibration

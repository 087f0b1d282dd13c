// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/loop/paper.h"

#include <algorithm>

#include "base/contracts.h"

namespace voxtone::halftone {

namespace {

constexpr float no_paper = 0.83f, all_paper = 0.95f;  // luminance: L* 93 and 98
constexpr float coloured = 0.6f, tinted = 0.75f;      // of the least linear channel to the greatest
constexpr double half_trusted = 0.1;                  // of the surface: half of what its level says is believed
constexpr double adaptation = 0.85;                   // D
constexpr float least_level = 0.2f;

float luminance(const Eigen::Vector3f& rgb) { return Eigen::Vector3f(0.2126f, 0.7152f, 0.0722f).dot(rgb); }

float smooth_step(float from, float to, float at) {
    const float x = std::clamp((at - from) / (to - from), 0.0f, 1.0f);
    return x * x * (3 - 2 * x);
}

}  // namespace

float paper_weight(const Eigen::Vector3f& target) {
    const float light = smooth_step(no_paper, all_paper, luminance(target));
    return light > 0 ? light * smooth_step(coloured, tinted, target.minCoeff() / target.maxCoeff()) : 0;
}

float paper_level(const optics::Surface& surface, std::span<const Eigen::Vector3f> target,
                  std::span<const Eigen::Vector3f> print) {
    VOXTONE_EXPECT(target.size() == surface.cells.size() && print.size() == target.size());
    double paper = 0, light = 0, area = 0;
    for (std::size_t i = 0; i < target.size(); ++i) {
        const double a = surface.cells[i].area_mm2, w = a * static_cast<double>(paper_weight(target[i]));
        area += a, paper += w;
        if (w > 0) light += w * static_cast<double>(luminance(print[i]) / luminance(target[i]));
    }
    if (paper <= 0) return 1;
    const double share = paper / area,
                 trust = adaptation * share * share / (share * share + half_trusted * half_trusted);
    return std::max(least_level, static_cast<float>(1 - trust * (1 - light / paper)));
}

}  // namespace voxtone::halftone

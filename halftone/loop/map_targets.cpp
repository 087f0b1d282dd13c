// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/loop/map_targets.h"

#include <algorithm>

#include "base/parallel.h"
#include "optics/colour/colour.h"

namespace voxtone::halftone {

namespace {

constexpr float barely = 1e-3f;  // of Oklab's lightness, 0 to 1

Eigen::Vector3d oklab(const Eigen::Vector3f& rgb) {
    return optics::oklab_from_linear_srgb(rgb.cast<double>().cwiseMax(0));
}

}  // namespace

std::vector<Eigen::Vector3f> map_targets(std::span<const Eigen::Vector3f> target,
                                         const std::function<Eigen::Vector3f(const Eigen::Vector3f&)>& into_gamut,
                                         const std::function<const EyeFilter&()>& spread) {
    std::vector<Eigen::Vector3f> mapped(target.size()), taken(target.size());
    parallel_for(0, target.size(), 256, [&](std::size_t i) {
        mapped[i] = into_gamut(target[i]);
        taken[i].setConstant(static_cast<float>(oklab(target[i])[0] - oklab(mapped[i])[0]));
    });
    if (std::none_of(taken.begin(), taken.end(), [](const Eigen::Vector3f& d) { return std::abs(d[0]) > barely; }))
        return mapped;
    const std::vector<Eigen::Vector3f> mean = spread().smoothed(taken);
    parallel_for(0, target.size(), 256, [&](std::size_t i) {
        if (mapped[i] == target[i]) return;
        Eigen::Vector3d lab = oklab(mapped[i]);
        lab[0] = std::clamp(lab[0] + static_cast<double>(taken[i][0] - mean[i][0]), 0.0, 1.0);
        mapped[i] = into_gamut(optics::linear_srgb_from_oklab(lab).cast<float>().cwiseMax(0).cwiseMin(1));
    });
    return mapped;
}

}  // namespace voxtone::halftone

// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/loop/minimal_depth_separation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/contracts.h"
#include "base/parallel.h"
#include "halftone/separation/lattice_lookup.h"

namespace voxtone::halftone {

namespace {

constexpr std::size_t nodes = 33;

/// CIEDE2000 from where on a colour is moved towards what can be shown; all the way from twice as much.
constexpr double moved_from = 1;
/// And at all nodes of a lattice cube whose colours are not looked at one by one: half of it leaves room for what lies
/// between the nodes (4000 random colours come out the same, minimal_depth_separation_test.cpp).
constexpr double at_node = 0.5;

float share_within(double excess, double tolerance) {
    return static_cast<float>(std::clamp((3 * tolerance - excess) / (2 * tolerance), 0.0, 1.0));
}

}  // namespace

MinimalDepthSeparation::MinimalDepthSeparation(const optics::ResinSet& resins, const optics::ShellGeometry& geometry,
                                               const SkinLayers& layers, const SeparationOptions& options,
                                               const Progress* progress, double tolerance)
    : layers_(layers), resins_(resins.resins.size()), core_(static_cast<std::size_t>(geometry.core_resin)) {
    VOXTONE_EXPECT(layers.size() >= 2 && tolerance > 0);
    for (std::size_t l = 1; l < layers.size(); ++l) {
        optics::ShellGeometry skin = geometry;
        skin.shell_mm = layers.bottom_mm[l];
        skin.core_mm = geometry.core_mm + layers.depth_mm() - skin.shell_mm;
        skins_.push_back(std::make_unique<const Skin>(resins, skin, options, progress));
    }
    weight_.resize(nodes * nodes * nodes * skins_.size());
    std::vector<char> in_gamut(nodes * nodes * nodes);
    parallel_for(
        0, nodes * nodes, 8,
        [&](std::size_t row) {
            if (progress) progress->check_cancelled();
            const auto coordinate = [](std::size_t i) {
                const float t = static_cast<float>(i) / static_cast<float>(nodes - 1);
                return t * t * t;
            };
            for (std::size_t red = 0; red < nodes; ++red) {
                const Eigen::Vector3f rgb(coordinate(red), coordinate(row % nodes), coordinate(row / nodes));
                const double least = deepest().gamut_distance(rgb);
                in_gamut[row * nodes + red] = least < at_node;
                float left = 1, *const weight = weight_.data() + (row * nodes + red) * skins_.size();
                for (std::size_t s = 0; s + 1 < skins_.size(); ++s) {
                    weight[s] = left * share_within(skins_[s]->separation.gamut_distance(rgb) - least, tolerance);
                    left -= weight[s];
                }
                weight[skins_.size() - 1] = left;
            }
        },
        progress);
    well_in_gamut_.assign(in_gamut.size(), 0);
    for (std::size_t z = 0; z + 1 < nodes; ++z)
        for (std::size_t y = 0; y + 1 < nodes; ++y)
            for (std::size_t x = 0; x + 1 < nodes; ++x) {
                bool all = true;
                for (std::size_t corner = 0; corner < 8; ++corner)
                    all = all &&
                          in_gamut[((z + (corner >> 2)) * nodes + y + (corner >> 1 & 1)) * nodes + x + (corner & 1)];
                well_in_gamut_[(z * nodes + y) * nodes + x] = all;
            }
}

bool MinimalDepthSeparation::well_in_gamut(const Eigen::Vector3f& rgb) const {
    std::size_t at = 0;
    for (int c = 2; c >= 0; --c) {
        const float place = std::cbrt(std::clamp(rgb[c], 0.0f, 1.0f)) * static_cast<float>(nodes - 1);
        at = at * nodes + std::min(static_cast<std::size_t>(place), nodes - 2);
    }
    return well_in_gamut_[at] != 0;
}

const float* MinimalDepthSeparation::weights(const Eigen::Vector3f& rgb) const {
    std::size_t at = 0;
    for (int c = 2; c >= 0; --c)
        at = at * nodes + static_cast<std::size_t>(
                              std::lround(std::cbrt(std::clamp(rgb[c], 0.0f, 1.0f)) * static_cast<float>(nodes - 1)));
    return weight_.data() + at * skins_.size();
}

void MinimalDepthSeparation::separate(const Eigen::Vector3f& rgb, std::span<float> fractions) const {
    VOXTONE_EXPECT(fractions.size() == layers_.size() * resins_);
    std::fill(fractions.begin(), fractions.end(), 0.0f);
    const float* const weight = weights(rgb);
    for (std::size_t s = 0; s < skins_.size(); ++s) {
        if (weight[s] <= 0) continue;
        std::array<float, max_resins> share;
        skins_[s]->separation.shares(rgb, share.data());
        float sum = 0;
        for (std::size_t r = 0; r < resins_; ++r) sum += share[r];
        for (std::size_t r = 0; r < resins_; ++r) share[r] /= sum;
        for (std::size_t l = 0; l < layers_.size(); ++l) {
            float* const layer = fractions.data() + l * resins_;
            if (l > s + 1) {  // skin s reaches down to layer s + 1
                layer[core_] += weight[s];
                continue;
            }
            for (std::size_t r = 0; r < resins_; ++r) layer[r] += weight[s] * share[r];
        }
    }
}

void MinimalDepthSeparation::separate_in_depth(const Eigen::Vector3f& rgb, std::span<float> fractions) const {
    VOXTONE_EXPECT(fractions.size() == layers_.size() * resins_);
    const std::vector<double> share = deepest().fractions(rgb);
    for (std::size_t i = 0; i < fractions.size(); ++i) fractions[i] = static_cast<float>(share[i % resins_]);
}

Eigen::Vector3f MinimalDepthSeparation::into_gamut(const Eigen::Vector3f& rgb) const {
    if (well_in_gamut(rgb)) return rgb;
    const double distance = deepest().gamut_distance(rgb);
    const auto moved = static_cast<float>(std::clamp(distance - moved_from, 0.0, 1.0));
    if (moved <= 0) return rgb;
    return rgb + moved * (deepest().predicted(rgb).cast<float>() - rgb);
}

}  // namespace voxtone::halftone

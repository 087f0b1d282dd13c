// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/loop/minimal_depth_separation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/contracts.h"
#include "halftone/separation/lattice_lookup.h"
#include "optics/numerics/portable_math.h"

namespace voxtone::halftone {

namespace {

constexpr std::size_t nodes = 33, all_nodes = nodes * nodes * nodes;

Eigen::Vector3f colour_of(std::size_t node) {
    const auto coordinate = [](std::size_t i) {
        const float t = static_cast<float>(i) / static_cast<float>(nodes - 1);
        return t * t * t;
    };
    return {coordinate(node % nodes), coordinate(node / nodes % nodes), coordinate(node / nodes / nodes)};
}

/// CIEDE2000 from where on a colour is moved towards what can be shown; all the way from twice as much.
constexpr double moved_from = 1;
/// And at all nodes of a lattice cube whose colours are not looked at one by one: half of it leaves room for what lies
/// between the nodes (4000 random colours come out the same, minimal_depth_separation_test.cpp).
constexpr double at_node = 0.5;

float share_within(double excess, double tolerance) {
    return static_cast<float>(std::clamp((3 * tolerance - excess) / (2 * tolerance), 0.0, 1.0));
}

}  // namespace

MinimalDepthSeparation::MinimalDepthSeparation(const optics::ShellAppearance& deepest, const SkinLayers& layers,
                                               const SeparationOptions& options, double tolerance)
    : layers_(layers),
      tolerance_(tolerance),
      resins_(deepest.resins()),
      core_(static_cast<std::size_t>(deepest.geometry().core_resin)),
      least_distance_(all_nodes),
      weight_(all_nodes * (layers.size() - 1)),
      measured_(all_nodes),
      weighed_(all_nodes) {
    VOXTONE_EXPECT(layers.size() >= 2 && tolerance > 0 && deepest.geometry().shell_mm == layers.depth_mm());
    for (std::size_t l = 1; l + 1 < layers.size(); ++l) {
        optics::ShellGeometry skin = deepest.geometry();
        skin.shell_mm = layers.bottom_mm[l];
        skin.core_mm = skin.core_mm + layers.depth_mm() - skin.shell_mm;
        skins_.push_back(std::make_unique<const Skin>(optics::ShellAppearance(deepest.set(), skin), options));
    }
    skins_.push_back(std::make_unique<const Skin>(deepest, options));
}

double MinimalDepthSeparation::least_distance(std::size_t node) const {
    measured_.require(node, node, [&] {
        least_distance_[node] = deepest().gamut_distance(colour_of(node));
        measured_.mark(node);
    });
    return least_distance_[node];
}

bool MinimalDepthSeparation::well_in_gamut(const Eigen::Vector3f& rgb) const {
    std::size_t at = 0;
    for (int c = 2; c >= 0; --c) {
        const float place = portable::cbrt(std::clamp(rgb[c], 0.0f, 1.0f)) * static_cast<float>(nodes - 1);
        at = at * nodes + std::min(static_cast<std::size_t>(place), nodes - 2);
    }
    for (std::size_t corner = 0; corner < 8; ++corner)
        if (!(least_distance(at + ((corner >> 2) * nodes + (corner >> 1 & 1)) * nodes + (corner & 1)) < at_node))
            return false;
    return true;
}

const float* MinimalDepthSeparation::weights(const Eigen::Vector3f& rgb) const {
    std::size_t node = 0;
    for (int c = 2; c >= 0; --c)
        node = node * nodes + static_cast<std::size_t>(std::lround(portable::cbrt(std::clamp(rgb[c], 0.0f, 1.0f)) *
                                                                   static_cast<float>(nodes - 1)));
    float* const weight = weight_.data() + node * skins_.size();
    weighed_.require(node, node, [&] {
        const double least = least_distance(node);
        float left = 1;
        for (std::size_t s = 0; s + 1 < skins_.size(); ++s) {
            const double excess = skins_[s]->separation.gamut_distance(colour_of(node)) - least;
            weight[s] = left * share_within(excess, tolerance_);
            left -= weight[s];
        }
        weight[skins_.size() - 1] = left;
        weighed_.mark(node);
    });
    return weight;
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

Eigen::Vector3f MinimalDepthSeparation::into_gamut(const Eigen::Vector3f& rgb) const {
    if (well_in_gamut(rgb)) return rgb;
    const double distance = deepest().gamut_distance(rgb);
    const auto moved = static_cast<float>(std::clamp(distance - moved_from, 0.0, 1.0));
    if (moved <= 0) return rgb;
    return rgb + moved * (deepest().predicted(rgb).cast<float>() - rgb);
}

}  // namespace voxtone::halftone

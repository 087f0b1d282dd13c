// SPDX-License-Identifier: GPL-3.0-or-later
//
// Surface first: the same colours in as thin and concentrated a skin as can show them, over the core.
//
// Light that passes coloured voxels sideways takes their colour along: the thinner the skin, the sharper the print. A
// thin skin has a smaller gamut, though, so several separations are made, for skins of rising depth (one each for the
// second and every deeper layer of `SkinLayers`), and a colour takes the thinnest that shows it: with D the CIEDE2000
// between the colour and what a skin makes of it, and D_min that of the deepest skin, a skin is good where D - D_min is
// below `tolerance`, bad where it is above 3 tolerance, and in between it is mixed with the next deeper one, so that no
// border is seen where the depth changes.
//
// What it cannot see: neighbours. The loop mends that. May be asked from any thread; the same bits in any order.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "halftone/loop/skin.h"
#include "halftone/separation/made_on_demand.h"
#include "halftone/separation/separation.h"
#include "optics/layered/shell_appearance.h"

namespace voxtone::halftone {

class MinimalDepthSeparation {
public:
    /// `deepest`: of a skin as deep as all layers. Throws as ShellAppearance and Separation do.
    MinimalDepthSeparation(const optics::ShellAppearance& deepest, const SkinLayers& layers,
                           const SeparationOptions& options, double tolerance = 1);

    [[nodiscard]] const SkinLayers& layers() const { return layers_; }
    [[nodiscard]] std::size_t resins() const { return resins_; }
    /// The mixture of each layer that shows `rgb` (linear sRGB, media-relative, clamped to [0, 1]): layers x resins.
    void separate(const Eigen::Vector3f& rgb, std::span<float> fractions) const;
    /// The separation for the deepest skin: its gamut is that of all.
    [[nodiscard]] const Separation& deepest() const { return skins_.back()->separation; }
    /// A colour of which the deepest skin is at most 1 CIEDE2000 off stays; from 2 on it goes to what that skin shows
    /// for it, in between part of the way.
    [[nodiscard]] Eigen::Vector3f into_gamut(const Eigen::Vector3f& rgb) const;

private:
    struct Skin {
        Skin(const optics::ShellAppearance& seen, const SeparationOptions& options)
            : appearance(seen), separation(appearance, options) {}
        optics::ShellAppearance appearance;
        Separation separation;
    };
    /// Share of each skin.
    [[nodiscard]] const float* weights(const Eigen::Vector3f& rgb) const;
    /// All of the lattice's nodes around are within `at_node` of what is shown for them.
    [[nodiscard]] bool well_in_gamut(const Eigen::Vector3f& rgb) const;
    /// CIEDE2000 between a node's colour and what the deepest skin shows for it.
    [[nodiscard]] double least_distance(std::size_t node) const;

    SkinLayers layers_;
    double tolerance_;
    std::size_t resins_, core_;
    std::vector<std::unique_ptr<const Skin>> skins_;
    // Of the nodes of a lattice even in the cube root of each channel, red fastest: found out where they are asked for,
    // like a separation's mixtures.
    mutable std::vector<double> least_distance_;
    mutable std::vector<float> weight_;  ///< [node * skins + skin]
    mutable MadeOnDemand measured_, weighed_;
};

}  // namespace voxtone::halftone

// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much of a print of a colour is resin that is not clear, where it is to have a translucency alpha
// (optics/layered/translucency_alpha.h).
//
// A print that is made k times as thin of everything but clear resin is, to light, the same print with all lengths
// divided by k. So a body whose shell goes down to depth / k, of mixtures that hold the share k of what they held, and
// whose core holds that share of the core's resin, looks as the undiluted body does wherever it is thick; only how far
// light gets in it changes. What k gives which alpha is found once a job: for colours of a lattice and a ladder of k
// the standard's slab of 4 mm, coloured from above as the print is, is computed by the modes of its layers with voxels
// of clear among the others (effective_medium.h), and read; a picture's slab that is thinner as it is, as greys as
// thin; where hardly any light comes through, as of dark colours, eta goes on in proportion to k. Alpha grows with k;
// it is inverted in between. A colour is opaque enough at k = 1: an alpha above what the resins show there prints as k
// = 1 does, to the bit.
//
// Kept and looked up are sqrt(k) over sqrt(eta), which is a straight line where a print is homogeneous. The lattice is
// even in the cube root of linear channels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "halftone/separation/mixture.h"
#include "halftone/separation/separation.h"
#include "optics/layered/shell_appearance.h"
#include "optics/layered/translucency_alpha.h"

namespace voxtone::halftone {

class Translucency {
public:
    /// `separation`: of `appearance`, which is what of shell and core is asked. `clear`: index of the clear resin.
    Translucency(const optics::ShellAppearance& appearance, const Separation& separation, int clear);

    /// k of a colour in linear sRGB; in [0, 1], 1 for an alpha of 1. One of few values, so that voxels can be kept with
    /// it: these steps are even in sqrt(k), and each is 0.002 of alpha or less.
    [[nodiscard]] float kept(const Eigen::Vector3f& rgb, float alpha) const { return kept_of(kept_step(rgb, alpha)); }
    [[nodiscard]] std::uint32_t kept_step(const Eigen::Vector3f& rgb, float alpha) const;
    static constexpr std::uint32_t kept_steps = 1024;
    [[nodiscard]] static float kept_of(std::uint32_t step) {
        const float root = float(step) / float(kept_steps - 1);
        return root * root;
    }
    /// The alpha that its resins show where so much of them is kept; k in [0, 1].
    [[nodiscard]] double shown_alpha(const Eigen::Vector3f& rgb, float k) const;
    [[nodiscard]] int clear() const { return clear_; }
    /// So much of the mixture, the rest clear; k = 1 changes nothing.
    [[nodiscard]] CumulativeMixture diluted(const CumulativeMixture& mixture, float k) const;

    /// The print's own thickness where it is a slab, at most the standard's.
    [[nodiscard]] static double slab_mm(const optics::ShellGeometry& geometry);
    /// A slab of this thickness as it would be printed of a colour with this k.
    [[nodiscard]] optics::SlabReading reading(const Eigen::Vector3f& rgb, double k) const;

private:
    static constexpr std::size_t edge = 6, steps = 15, etas = 48, alphas = 1025;
    const optics::ShellAppearance& appearance_;
    const Separation& separation_;
    int clear_;
    double most_root_eta_ = 0;
    std::vector<float> root_kept_;                        ///< [colour * etas + root of eta]
    std::vector<float> root_eta_;                         ///< [alpha], over most_root_eta_
    std::vector<std::array<double, steps>> root_eta_of_;  ///< [colour][step of the ladder]
};

}  // namespace voxtone::halftone

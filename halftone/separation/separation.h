// SPDX-License-Identifier: GPL-3.0-or-later
//
// Colour separation: which mixture of the loaded resins shows a target colour.
//
// The forward model is optics::ShellAppearance, media-relative and read as linear sRGB: the white of a target is a
// body of white resin. It is inverted at the nodes of a lattice over the colour cube, when a colour next to a node is
// first looked up, and interpolated in between.
//
// At a node with target T the fractions f of the resins minimise
//     | W (oklab(A(f)) - oklab(T)) |^2  +  lambda sum_r p_r f_r^2,    f_r >= 0,  sum_r f_r = 1.
// - In gamut the first term reaches 0 and the second chooses among the mixtures that look alike: the least ink, in the
//   sense of squares, which shares a dark neutral smoothly between black and the chromatic resins. lambda is so small
//   that it costs no visible colour.
// - Out of gamut the first term decides where the colour goes. W is diagonal in lightness, chroma and hue of the target
//   and weighs hue most: chroma and lightness give way, hue stays (Oklab, Ottosson 2020, is straight in hue where
//   CIELAB bends). No channel is clipped by itself.
//
// Lattice: nodes even in the cube root of each linear channel, so in lightness, interpolated tetrahedrally. Next to
// white f grows as the square of the distance, so sqrt(f) is straight there; where one ink replaces another f itself
// is. The mean of both interpolations is taken: it halves the worst error of either.
//
// Spectral sets: the spectrum, media-relative, is seen under D65 by the CIE 1931 observer and scaled so that white has
// (1, 1, 1) (Bradford).
//
// Range: targets in [0, 1]^3; others are clamped first. Errors, CIEDE2000, of colours of random mixtures that were
// looked up and seen again (separation_test.cpp; two samples of 2000 and 3000; mean / max): CMYKW 0.16 / 1.47, CMYW
// 0.19 / 1.07, CMW 0.16 / 1.47, KW 0.05 / 0.5; KWC 0.21 / 2.2 and CMYKW with clear 0.17 / 2.2, because many of their
// colours lie on the edge of the gamut, where it cuts through cells. Saturated colours out of gamut turn in hue by at
// most 5.2 degrees (Oklab). What it cannot see: whatever the forward model cannot (edges, curvature, grain of the
// halftone). May be asked from any thread; the same bits for any number of threads and any order.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "halftone/separation/appearance_colour.h"
#include "halftone/separation/lattice_lookup.h"
#include "halftone/separation/mixture.h"
#include "halftone/separation/mixture_lattice.h"
#include "halftone/separation/separation_options.h"
#include "optics/layered/shell_appearance.h"

namespace voxtone::halftone {

class Separation {
public:
    /// `appearance` has at most max_resins resins; it must outlive the separation.
    /// Throws InputError for channels that are not those of the options, UsageError for options out of range.
    explicit Separation(const optics::ShellAppearance& appearance, const SeparationOptions& options = {});

    [[nodiscard]] std::size_t resins() const { return resins_; }

    /// Mixtures of n colours, given as separate arrays of linear sRGB channels; the hot path.
    void mixtures(const float* red, const float* green, const float* blue, std::size_t n, CumulativeMixture* out) const;

    /// Shares of one colour, max_resins of them; their sum is near 1.
    void shares(const Eigen::Vector3f& rgb, float* out) const {
        lattice_shares(lattice_.view(), rgb.x(), rgb.y(), rgb.z(), out);
    }
    /// Fractions of one colour; they sum to 1.
    [[nodiscard]] std::vector<double> fractions(const Eigen::Vector3f& rgb) const;
    /// The colour that the forward model gives for `fractions(rgb)`: linear sRGB, media-relative.
    [[nodiscard]] Eigen::Vector3d predicted(const Eigen::Vector3f& rgb) const;
    /// CIEDE2000 between the target and `predicted(rgb)`: how far the colour had to be moved (and, in gamut, the error
    /// of the interpolation).
    [[nodiscard]] double gamut_distance(const Eigen::Vector3f& rgb) const;

private:
    AppearanceColour colour_;
    std::size_t resins_;
    mutable MixtureLattice lattice_;  ///< solved where it is asked for
};

}  // namespace voxtone::halftone

// SPDX-License-Identifier: GPL-3.0-or-later
//
// How a painted surface looks from a distance: what the eye cannot resolve is averaged, in colour more than in light.
//
// A sum of Gaussians exp(-(r / spread)^2) of unit integral smooths each of three opponent channels. They are those of
// X. Zhang, B. A. Wandell, "A spatial extension of CIELAB for digital color-image reproduction", J. SID 5, 61 (1997),
// whose figures come from A. B. Poirson, B. A. Wandell, J. Opt. Soc. Am. A 10, 2458 (1993):
//
//   channel        weight, spread in degrees of visual angle
//   luminance      0.921, 0.0283;  0.105, 0.133;  -0.108, 4.336
//   red-green      0.531, 0.0392;  0.330, 0.494
//   blue-yellow    0.488, 0.0536;  0.371, 0.386
//
// weights of a channel scaled to the sum 1, so that flat colours stay as they are. The channels:
//
//   OpponentSpace   luminance                        red-green                        blue-yellow
//   cielab          Y                                a* of what G leaves              b* of what G leaves
//   neutral         0.0556 X + 0.9981 Y - 0.0254 Z   0.9510 X - 0.9038 Y              0.0386 X + 1.0822 Y - 1.0276 Z
//   published       0.279 X + 0.72 Y - 0.107 Z       -0.449 X + 0.29 Y - 0.077 Z      0.086 X - 0.59 Y + 0.501 Z
//
// In `cielab` light comes through the narrowest Gaussian of luminance, G, whatever its colour; then luminance is
// smoothed on as light, and colour as it is perceived: L* of the luminance, a* and b* as they are smoothed are what is
// seen. Where colour is smoothed as light, a hundredth of white's colour is as much as all that black has: black beside
// white takes up the white's tint a millimetre wide, many times its own (docs/decisions/001). That is what S-CIELAB
// does: `published` is Zhang and Wandell's. White is not neutral there (red-green -0.22), so that every edge between
// black and white gets coloured fringes and black beside white counts as green. `neutral` is Y'C1C2 (E. Reinhard, E. A.
// Khan, A. O. Akyuz, G. M. Johnson, "Color Imaging", A K Peters 2008; J. Preiss, F. Fernandes, P. Urban, IEEE Trans.
// Image Processing 23, 1366 (2014) filter in it): white is neutral to 3e-4. Both are kept for judges of a loop that
// does not go by them. The authors' own program states half widths at half height of the same Gaussians (0.05, 0.225,
// 7.0; 0.0685, 0.826; 0.092, 0.6451 as full widths), 6 % wider at most: that pins the meaning of "spread".
//
// On a surface the distance between two places is their chord, seen along the normal from `viewing_distance_mm`; what
// is not seen together does not mix (surface_smoothing.h). Wider Gaussians are applied to what the narrowest has
// smoothed. Transfer function within 0.015 of the sum of Gaussians' for cells of 0.1 mm and less, seen from 300 mm and
// more.
//
// What it cannot see: that sensitivity grows with the light there is and depends on the direction of stripes (less at
// 45 degrees); the optics' glare; masking of errors by a busy neighbourhood; foreshortening, shadows and gloss; that a
// viewer may come nearer. The wide Gaussian of luminance is negative: it takes 12 % of the mean luminance within 4
// degrees from every place and amplifies what is finer by as much. Places darker than that are black or less
// afterwards, so that differences in the dark beside bright areas count for more than a person sees.
// `EyeSurround::none` leaves it out.
//
// Time for a million cells (67 cm2): 2.1 core-seconds to build, 2.1 to filter, 0.6 for `smoothed`. Memory: 0.2 kB per
// cell. Same bits for any number of threads.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "optics/scene/appearance_model.h"

namespace voxtone::halftone {

/// What the widest Gaussian of luminance, which is negative, does.
enum class EyeSurround {
    published,  ///< as the authors have it, for scores in S-CIELAB (benchmarks/slicer/print/scores.h)
    none,       ///< left out, the other two scaled to the sum 1: a low-pass
};

enum class OpponentSpace {
    cielab,     ///< colour as it is perceived
    neutral,    ///< Y'C1C2, as light
    published,  ///< Zhang and Wandell's, as light: S-CIELAB to the letter
};

enum class EyeParts {
    all,
    narrowest,  ///< for `smoothed` alone: a sixth of the time and memory
};

class EyeFilter {
public:
    /// The surface is not needed afterwards. Throws InputError for a distance that is not above 0.
    EyeFilter(const optics::Surface& surface, double viewing_distance_mm, EyeSurround surround = EyeSurround::none,
              OpponentSpace space = OpponentSpace::cielab, EyeParts parts = EyeParts::all);
    ~EyeFilter();
    EyeFilter(EyeFilter&&) noexcept;
    EyeFilter& operator=(EyeFilter&&) noexcept;

    /// What is seen of linear sRGB per cell, in CIELAB, and what the narrowest Gaussian left on the way to it.
    struct Views {
        std::vector<Eigen::Vector3f> lab, smoothed;
    };
    [[nodiscard]] Views views(std::span<const Eigen::Vector3f> rgb) const;
    /// Of two pictures, in hardly more than the time of one.
    [[nodiscard]] std::array<Views, 2> views(std::span<const Eigen::Vector3f> first,
                                             std::span<const Eigen::Vector3f> second) const;
    /// What is seen, as linear sRGB: not clamped.
    [[nodiscard]] std::vector<Eigen::Vector3f> filter(std::span<const Eigen::Vector3f> rgb) const;

    /// d F / d smoothed from d F / d lab at `views`, each divided by its cell's area; in `cielab` alone. Right where
    /// the Gaussians' sums of areas are alike, so not within a spread of a border.
    [[nodiscard]] std::vector<Eigen::Vector3f> by_smoothed(std::span<const Eigen::Vector3f> by_lab,
                                                           const Views& views) const;

    /// Only the narrowest Gaussian of luminance, on all channels alike: a cheap low-pass for feedback in a loop. It
    /// removes what cannot be seen and leaves what can nearly as it is.
    [[nodiscard]] std::vector<Eigen::Vector3f> smoothed(std::span<const Eigen::Vector3f> rgb) const;

private:
    /// One or two pictures, cell by cell: channels of what the narrowest leaves, and smoothed by what each has besides.
    using Channels = std::array<std::vector<float>, 3>;
    [[nodiscard]] Channels channels_of(std::span<const Eigen::Vector3f> smoothed) const;
    [[nodiscard]] Channels through(const Channels& channels) const;
    [[nodiscard]] std::vector<Eigen::Vector3f> lab_of(std::span<const Eigen::Vector3f> smoothed) const;
    struct Data;
    std::unique_ptr<Data> data_;
};

/// Of `neutral` and `published`: rows luminance, red-green, blue-yellow; columns X, Y, Z.
[[nodiscard]] const Eigen::Matrix3d& opponent_from_xyz_matrix(OpponentSpace space);

}  // namespace voxtone::halftone

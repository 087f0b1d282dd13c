// SPDX-License-Identifier: GPL-3.0-or-later
//
// How a painted surface looks from a distance: what the eye cannot resolve is averaged, in colour more than in light.
//
// Linear colour is taken to three opponent channels, each is smoothed by a sum of Gaussians exp(-(r / spread)^2) of
// unit integral, and taken back. The Gaussians are those of X. Zhang, B. A. Wandell, "A spatial extension of CIELAB for
// digital color-image reproduction", J. SID 5, 61 (1997), whose figures come from A. B. Poirson, B. A. Wandell, J. Opt.
// Soc. Am. A 10, 2458 (1993):
//
//   channel        weight, spread in degrees of visual angle
//   luminance      0.921, 0.0283;  0.105, 0.133;  -0.108, 4.336
//   red-green      0.531, 0.0392;  0.330, 0.494
//   blue-yellow    0.488, 0.0536;  0.371, 0.386
//
// weights of a channel scaled to the sum 1, so that flat colours stay as they are. The channels from X, Y, Z:
//
//   OpponentSpace      neutral                         published
//   luminance          0.0556   0.9981  -0.0254        0.279   0.72   -0.107
//   red-green          0.9510  -0.9038   0            -0.449   0.29   -0.077
//   blue-yellow        0.0386   1.0822  -1.0276        0.086  -0.59    0.501
//
// `published` is Zhang and Wandell's. White is not neutral there (red-green -0.22), and red-green is smoothed more than
// luminance: every edge between black and white gets coloured fringes 2.6 mm wide, black beside white counts as green,
// and a loop that follows it makes such blacks purple. `neutral` is Y'C1C2 (E. Reinhard, E. A. Khan, A. O. Akyuz, G. M.
// Johnson, "Color Imaging", A K Peters 2008; J. Preiss, F. Fernandes, P. Urban, IEEE Trans. Image Processing 23, 1366
// (2014) filter in it): white is neutral to 3e-4, edges without colour stay so. The authors' own program states half
// widths at half height of the same Gaussians (0.05, 0.225, 7.0; 0.0685, 0.826; 0.092, 0.6451 as full widths), 6 %
// wider at most: that pins the meaning of "spread".
//
// On a surface the distance between two places is their chord, seen along the normal from `viewing_distance_mm`; what
// is not seen together does not mix (surface_smoothing.h). Wider Gaussians are applied to what the narrowest has
// smoothed. Transfer function within 0.015 of the sum of Gaussians' for cells of 0.1 mm and less, seen from 300 mm and
// more.
//
// What it cannot see: that sensitivity grows with the light there is and depends on the direction of stripes (less at
// 45 degrees); the optics' glare; masking of errors by a busy neighbourhood; foreshortening, shadows and gloss; that a
// viewer may come nearer. The wide Gaussian of luminance is negative: it takes 12 % of the mean luminance within 4
// degrees from every place and amplifies what is finer by as much. Places darker than that are black or less afterwards
// (negative values; clamp them before Lab), so that differences in the dark beside bright areas count for more than a
// person sees. `EyeSurround::none` leaves it out. The wide Gaussians of colour do the same: a hundredth of white's
// colour is as much as all that black has, so that beside white a slight tint of the white counts as a strong one of
// the black (docs/decisions/001); `smoothed` is without them.
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
    published,  ///< as the authors have it, for scores in S-CIELAB (benchmarks/slicer/job/scores.h)
    none,       ///< left out, the other two scaled to the sum 1: a low-pass
};

enum class OpponentSpace {
    neutral,    ///< Y'C1C2
    published,  ///< Zhang and Wandell's: S-CIELAB to the letter
};

enum class EyeParts {
    all,
    narrowest,  ///< for `smoothed` alone: a sixth of the time and memory
};

class EyeFilter {
public:
    /// The surface is not needed afterwards. Throws InputError for a distance that is not above 0.
    EyeFilter(const optics::Surface& surface, double viewing_distance_mm, EyeSurround surround = EyeSurround::none,
              OpponentSpace space = OpponentSpace::neutral, EyeParts parts = EyeParts::all);
    ~EyeFilter();
    EyeFilter(EyeFilter&&) noexcept;
    EyeFilter& operator=(EyeFilter&&) noexcept;

    /// Linear sRGB per cell as it is seen: not clamped.
    [[nodiscard]] std::vector<Eigen::Vector3f> filter(std::span<const Eigen::Vector3f> rgb) const;

    /// `filter` and, on the way to it, `smoothed`.
    struct Views {
        std::vector<Eigen::Vector3f> filtered, smoothed;
    };
    [[nodiscard]] Views views(std::span<const Eigen::Vector3f> rgb) const;
    /// Of two pictures, in hardly more than the time of one.
    [[nodiscard]] std::array<Views, 2> views(std::span<const Eigen::Vector3f> first,
                                             std::span<const Eigen::Vector3f> second) const;

    /// d F / d rgb from d F / d seen, each divided by its cell's area: the transpose of `filter` where the Gaussians'
    /// sums of areas are alike, so not within a spread of a border.
    [[nodiscard]] std::vector<Eigen::Vector3f> transposed(std::span<const Eigen::Vector3f> by_seen) const;

    /// Only the narrowest Gaussian of luminance, on all channels alike: a cheap low-pass for feedback in a loop. It
    /// removes what cannot be seen and leaves what can nearly as it is.
    [[nodiscard]] std::vector<Eigen::Vector3f> smoothed(std::span<const Eigen::Vector3f> rgb) const;

private:
    /// into * (Gaussians of each opponent channel of (from * rgb)), given what the narrowest leaves. Of each of one or
    /// two pictures that lie cell by cell.
    [[nodiscard]] std::vector<Eigen::Vector3f> through(const Eigen::Matrix3f& from, const Eigen::Matrix3f& into,
                                                       std::span<const Eigen::Vector3f> smoothed) const;
    struct Data;
    std::unique_ptr<Data> data_;
};

/// Rows luminance, red-green, blue-yellow; columns X, Y, Z.
[[nodiscard]] const Eigen::Matrix3d& opponent_from_xyz_matrix(OpponentSpace space = OpponentSpace::neutral);

}  // namespace voxtone::halftone

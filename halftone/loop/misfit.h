// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far a print is from its target, as one number that has a derivative: what the appearance loop goes downhill on.
//
//   F = sum over cells i of  a_i ( r_i(E) + gamma r_i(N) + beta r_i(1) ),
//   r_i(A) = rho(| W (oklab(A p)_i - oklab(A t)_i) |),
//
// p what is predicted, t the target, a_i the cell's area / mean area times its weight, W = diag(1, 2, 2). E is the eye
// filter, which averages colour farther than light: a loop that mends colour cell by cell spends itself on what nobody
// sees. N is its narrowest Gaussian alone, for light and colour alike, gamma = 2: E by itself puts up with grain and
// halos of colour a millimetre wide, which are seen from nearer. beta = 0.03 decides little: of 0, 0.03, 0.3 the mean
// as seen was 2.77, 2.77, 2.78, cell by cell 6.15, 6.15, 6.07 (spot's texture, 8 mm wide, eight iterations, colour
// smoothed as light). rho(x) = sqrt(x^2 + s^2) - s counts small differences by their square and large ones (above s =
// 0.08, some 8 CIEDE2000) by themselves: dark detail beside white, which nothing can make darker, does not outweigh
// what can be mended.
//
// For contrast's sake the lightness d of the first two differences is replaced by d_i - k_i (S d)_i, S a Gaussian eight
// times as wide: what is off over more than a millimetre counts less then, what is off from its surroundings in full;
// k of each cell says where (lost_contrast.h). With k = 0 black text on white all but vanishes: light that leaks
// through white makes strokes pale whatever is done, and a little more of it on the wide paper outweighs the few dark
// strokes.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "halftone/loop/eye_filter.h"
#include "optics/scene/appearance_model.h"

namespace voxtone::halftone {

/// F, and d F / d p.
struct Misfit {
    double value = 0;
    std::vector<Eigen::Vector3f> by_colour;
};

inline constexpr double wider = 8;  ///< the spread of S / that of E

class MisfitFunction {
public:
    /// Keeps references. `weight`: per cell, empty: 1. `wide`: S, null for k = 0; `contrast_part`: k, per cell, in [0,
    /// 1].
    MisfitFunction(const optics::Surface& surface, const EyeFilter& eye, std::span<const Eigen::Vector3f> target,
                   std::span<const float> weight = {}, const EyeFilter* wide = nullptr,
                   std::vector<float> contrast_part = {});
    /// Per cell, from now on.
    void set_weights(std::span<const float> weight);
    [[nodiscard]] Misfit operator()(std::span<const Eigen::Vector3f> predicted) const {
        return (*this)(predicted, eye_.views(predicted));
    }
    /// The same, where it is known what the eye makes of them.
    [[nodiscard]] Misfit operator()(std::span<const Eigen::Vector3f> predicted, const EyeFilter::Views& views) const;

private:
    const EyeFilter& eye_;
    const EyeFilter* wide_;
    std::vector<float> contrast_part_;
    std::span<const Eigen::Vector3f> target_;
    EyeFilter::Views target_views_;
    std::vector<float> area_, weight_;
};

}  // namespace voxtone::halftone

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Photographs of one scene at rising exposure times, less their dark frames, as one picture of light per second.
//
//   x = sum_k w_k (lit_k - dark_k) / t_k  /  sum_k w_k,   w_k = t_k^2 / variance_k
//   variance_k = 2 read_noise^2 + (2 stray_k + x~ t_k) / full_well
//
// where values are parts of full scale, stray_k is how far the dark frame's median lies above that of the shortest dark
// frame, and x~ is what the exposures so far say, blurred by 3 px: were it a pixel's own value, low ones would weigh
// more than high ones, and means would be too dark. A sample counts where lit and dark frame are below saturation.
// Underexposed ones need no threshold, which would be biased as well: their weight falls with the square of the time.
//
// Based on: M. Granados, B. Ajdin, M. Wand, C. Theobalt, H.-P. Seidel, H. P. A. Lensch, "Optimal HDR reconstruction
// with linear digital cameras", CVPR 2010 (weights by the inverse variance of what is expected, found anew as more is
// known).
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "calibration/spot/exposure_series.h"

namespace voxtone::calibration {

struct CameraNoise {
    double full_well = 20000;  ///< electrons at full scale
    double read_noise = 2e-4;  ///< standard deviation, part of full scale
    double saturation = 0.95;  ///< samples from here on are left out, part of full scale
};

struct MergedPicture {
    std::uint32_t width_px = 0, height_px = 0;
    std::vector<Eigen::Vector3f> light;   ///< full scale per second
    std::vector<Eigen::Vector3f> weight;  ///< 1 / variance of it; 0 where no exposure counts
    std::vector<std::uint8_t> exposures;  ///< the longest that counts in all channels, counted from 1; 0: none
    std::vector<double> seconds;          ///< of each exposure
    /// Of each exposure but the first: how much brighter it is than the shorter ones let expect, where both are well
    /// exposed; 1 where nothing is. Times on a camera's dial are rounded: 1/15 s is often 1/16 s, 30 s is 32 s.
    std::vector<double> step;
    double cut_at_black =
        0;  ///< largest share of samples of a dark frame that are exactly 0: noise below black was cut off
    [[nodiscard]] std::size_t index(std::uint32_t x, std::uint32_t y) const { return std::size_t{y} * width_px + x; }
};

class ExposureMerge {
public:
    explicit ExposureMerge(const CameraNoise& noise) : noise_(noise) {}
    /// From short to long. Throws InputError where sizes differ, times do not rise, or the dark frame was exposed for
    /// another time (by more than 1 %).
    void add(const Exposure& lit, const Exposure& dark);
    /// Contract: at least one exposure.
    [[nodiscard]] MergedPicture merged() const;

private:
    CameraNoise noise_;
    Eigen::Vector3d black_ = Eigen::Vector3d::Zero();  ///< median of the first dark frame
    std::uint32_t width_px_ = 0, height_px_ = 0;
    std::vector<Eigen::Vector3f> weighted_, weight_;
    std::vector<std::uint8_t> exposures_;
    std::vector<double> seconds_, step_;
    double cut_at_black_ = 0;
};

}  // namespace voxtone::calibration

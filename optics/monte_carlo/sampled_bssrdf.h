// SPDX-License-Identifier: GPL-3.0-or-later
//
// How light that enters a flat body at one point leaves it at the others: the 4-D function R(x_i, x_o) on a grid of
// points, directions left out (a BSSRDF of diffuse light; Hasan et al. 2010, Sec. 7.1).
//
// A point stands for its cell, a square of pitch x pitch. R(x_i, x_o) is the light per mm^2 that leaves the cell of x_o
// of one unit of diffuse light that the surface let in, spread over the cell of x_i. Light has no preferred way: R(x_i,
// x_o) = R(x_o, x_i), so a pair is kept once. Kept are pairs up to `radius` apart; `total` says what leaves altogether,
// near and far.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/progress.h"
#include "optics/scene/appearance_model.h"

namespace voxtone::optics {

/// From a point to another, in points.
struct PointOffset {
    int x = 0, y = 0;
    friend bool operator==(const PointOffset&, const PointOffset&) = default;
};

/// One offset of each two that are opposite, within a radius; (0, 0) first, then by y and x.
[[nodiscard]] std::vector<PointOffset> half_window(std::uint32_t radius);

/// Of one channel.
struct ChannelResponses {
    /// [offset of the half window][point]: R(point, point + offset) in mm^-2; 0 where that lies outside.
    std::vector<float> pairs;
    std::vector<float> total;  ///< [point]: of one unit that entered there, what leaves at the top, wherever; in [0, 1]
    /// Variance of a value / the value, mm^-2: what one count is worth (of the pair of a point with itself: twice
    /// that). 0: values without noise.
    double noise = 0;
};

/// Rows from the top (y away from the observer runs up, as in a resin volume: row 0 has the largest y).
struct SampledBssrdf {
    std::uint32_t width = 0, height = 0;  ///< points
    std::uint32_t radius = 0;             ///< of the window, in points
    double pitch_mm = 0;
    std::vector<ChannelResponses> channels;

    [[nodiscard]] std::size_t points() const { return std::size_t{width} * height; }
    [[nodiscard]] double cell_mm2() const { return pitch_mm * pitch_mm; }
};

/// By point: the light that leaves within the window and the grid, of one unit that entered.
[[nodiscard]] std::vector<double> light_within_window(const SampledBssrdf& responses, std::size_t channel);

/// Of all light from points whose window lies within the grid, the share that leaves beyond the window; 0 where there
/// are none.
[[nodiscard]] double share_beyond_window(const SampledBssrdf& responses, std::size_t channel);

struct SampledBssrdfOptions {
    std::uint32_t width = 64, height = 64;  ///< points
    std::uint32_t margin = 12;              ///< cells around them that are no points
    std::uint32_t radius = 10;
    std::uint32_t paths = 1000;  ///< per point and channel
    std::uint64_t seed = 1;
    std::array<double, 2> columns{1, 1};  ///< of voxels, that a cell has along x and y; above 0, whole or not
    std::array<double, 2> first{0, 0};    ///< where the margin begins, in columns from the volume's corner
};

/// Traced through the volume (path_packets.h): all that the scene says is simulated as it is, the error is noise. Paths
/// from both points of a pair count for it. Contract: cells are squares (to 2 %) and lie on the volume to a column,
/// what sticks out enters at its edge; the top is flat and all resin. The same bits for any number of threads.
/// `progress` advances by points, channel by channel.
[[nodiscard]] SampledBssrdf trace_bssrdf(const Scene& scene, const SampledBssrdfOptions& options,
                                         Progress* progress = nullptr);

}  // namespace voxtone::optics

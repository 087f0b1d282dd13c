// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/media/lateral_spread.h"

#include <algorithm>
#include <cmath>

#include "base/contracts.h"
#include "optics/media/mirrored_box.h"

namespace voxtone::optics {
namespace {

/// The quadratic B-spline of variance 1: three even draws of width 2.
double spline(double u) {
    const double a = std::abs(u) / 2;  // in widths of a draw
    if (a >= 1.5) return 0;
    return a <= 0.5 ? (0.75 - a * a) / 2 : 0.5 * (1.5 - a) * (1.5 - a) / 2;
}

/// The mean over one voxel of what droplets bring that were jetted evenly over another, k on: the spline after a
/// triangle of two voxels.
std::vector<float> weights_of(double spread_voxels, int reach) {
    constexpr int steps = 512;
    std::vector<double> sum(static_cast<std::size_t>(2 * reach + 1));
    double all = 0;
    for (int k = 0; k <= reach; ++k) {
        double weight = 0;
        for (int i = 0; i < steps; ++i) {  // midpoints of the triangle's base, -1 to 1
            const double t = (2 * i + 1.0) / steps - 1;
            weight += (1 - std::abs(t)) * spline((k + t) / spread_voxels);
        }
        sum[static_cast<std::size_t>(reach + k)] = sum[static_cast<std::size_t>(reach - k)] = weight;
        all += k == 0 ? weight : 2 * weight;
    }
    std::vector<float> weights;
    for (const double s : sum) weights.push_back(static_cast<float>(s / all));
    return weights;
}

std::size_t count_of(const std::array<int, 3>& extent) {
    return static_cast<std::size_t>(extent[0]) * static_cast<std::size_t>(extent[1]) *
           static_cast<std::size_t>(extent[2]);
}

}  // namespace

LateralSpread::LateralSpread(const std::array<double, 2>& spread_mm, const std::array<double, 3>& pitch_mm) {
    // Narrower, the triangle's steps would miss the spline; and nobody could tell it from none.
    constexpr double narrowest_voxels = 0.02;
    for (std::size_t a = 0; a < 2; ++a) {
        VOXTONE_EXPECT(spread_mm[a] >= 0 && spread_mm[a] <= widest_spread_mm && pitch_mm[a] > 0);
        const double voxels = spread_mm[a] / pitch_mm[a];
        if (voxels < narrowest_voxels) continue;
        reach_[a] = static_cast<int>(std::ceil(3 * voxels));
        weights_[a] = weights_of(voxels, reach_[a]);
        draw_voxels_[a] = static_cast<float>(2 * voxels);
        farthest_mm_ = std::hypot(farthest_mm_, 3 * spread_mm[a]);
    }
}

double LateralSpread::kept_variance() const {
    double kept = 1;
    for (const std::vector<float>& weights : weights_) {
        double sum = 0;
        for (const float w : weights) sum += static_cast<double>(w) * static_cast<double>(w);
        kept *= sum;
    }
    return kept;
}

void SpreadBox::read_surroundings(const std::array<int, 3>& corner, const std::array<int, 3>& extent) {
    const std::array<int, 2>& reach = spread_->reach();
    read_box(*volume_, mirrored_, {corner[0] - reach[0], corner[1] - reach[1], corner[2]},
             {extent[0] + 2 * reach[0], extent[1] + 2 * reach[1], extent[2]}, box_);
}

int SpreadBox::only(const std::array<int, 3>& corner, const std::array<int, 3>& extent) {
    const std::array<int, 2>& reach = spread_->reach();
    const int whole = volume_->uniform_material({corner[0] - reach[0], corner[1] - reach[1], corner[2]},
                                                {extent[0] + 2 * reach[0], extent[1] + 2 * reach[1], extent[2]});
    if (whole >= 0) return whole;
    read_surroundings(corner, extent);
    return only_in_box();
}

int SpreadBox::only_in_box() const {
    int found = air;
    for (const Material m : box_) {
        if (m == air || m == found) continue;
        if (found != air) return -1;
        found = m;
    }
    return found;
}

void SpreadBox::read(const std::array<int, 3>& corner, const std::array<int, 3>& extent) {
    read_surroundings(corner, extent);
    shares_.assign(count_of(extent) * resins_, 0.0f);
    is_air_.assign(count_of(extent), 0);
    if (const int only = only_in_box(); only >= 0) {
        keep_layers(extent, only);
        return;
    }
    for (int z = 0; z < extent[2]; ++z) spread_layer(extent, z);
}

/// Of a box that one resin alone reaches.
void SpreadBox::keep_layers(const std::array<int, 3>& extent, int only) {
    const std::array<int, 2>& reach = spread_->reach();
    const int wide = extent[0] + 2 * reach[0], high = extent[1] + 2 * reach[1];
    std::size_t voxel = 0;
    for (int z = 0; z < extent[2]; ++z)
        for (int y = 0; y < extent[1]; ++y) {
            const Material* const row =
                box_.data() + (static_cast<std::ptrdiff_t>(z) * high + y + reach[1]) * wide + reach[0];
            for (int x = 0; x < extent[0]; ++x, ++voxel) {
                is_air_[voxel] = row[x] == air;
                if (row[x] != air) shares_[voxel * resins_ + static_cast<std::size_t>(only - 1)] = 1;
            }
        }
}

/// All resins of a layer along x, then along y; then each voxel takes back, in its own resin, what fell on air.
void SpreadBox::spread_layer(const std::array<int, 3>& extent, int z) {
    const auto rx = static_cast<std::size_t>(spread_->reach()[0]), ry = static_cast<std::size_t>(spread_->reach()[1]);
    const auto nx = static_cast<std::size_t>(extent[0]), ny = static_cast<std::size_t>(extent[1]);
    const std::size_t wide = nx + 2 * rx, high = ny + 2 * ry;
    const Material* const layer = box_.data() + static_cast<std::size_t>(z) * wide * high;
    const std::size_t first = static_cast<std::size_t>(z) * nx * ny, row = nx * resins_;
    const std::span<const float> x_weights = spread_->weights(0), y_weights = spread_->weights(1);
    along_x_.assign(row * high, 0.0f);
    for (std::size_t y = 0; y < high; ++y)
        for (std::size_t from = 0; from < wide; ++from) {
            const Material m = layer[y * wide + from];
            if (m == air) continue;
            // What is jetted `from` counts in the places x = from - k.
            const std::size_t least = from < nx ? 0 : from - nx + 1, most = std::min(from, x_weights.size() - 1);
            for (std::size_t k = least; k <= most; ++k)
                along_x_[y * row + (from - k) * resins_ + m - 1u] += x_weights[k];
        }
    for (std::size_t y = 0; y < ny; ++y) {
        float* const to = shares_.data() + (first + y * nx) * resins_;
        for (std::size_t k = 0; k < y_weights.size(); ++k) {
            const float* const from = along_x_.data() + (y + k) * row;
            const float weight = y_weights[k];
            for (std::size_t i = 0; i < row; ++i) to[i] += weight * from[i];
        }
    }
    for (std::size_t y = 0; y < ny; ++y)
        for (std::size_t x = 0; x < nx; ++x) {
            const std::size_t voxel = first + y * nx + x;
            const Material own = layer[(y + ry) * wide + x + rx];
            float* const shares = shares_.data() + voxel * resins_;
            if (own == air) {
                is_air_[voxel] = 1;
                std::fill_n(shares, resins_, 0.0f);
                continue;
            }
            float sum = 0;
            for (std::size_t r = 0; r < resins_; ++r) sum += shares[r];
            shares[own - 1u] += 1 - sum;
        }
}

}  // namespace voxtone::optics

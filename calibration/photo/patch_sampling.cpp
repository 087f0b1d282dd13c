// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/photo/patch_sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <Eigen/Cholesky>

namespace voxtone::calibration {

namespace {

struct Block {
    Eigen::Vector3d value = Eigen::Vector3d::Zero();
    double x = 0, y = 0;  // about the middle of the area, in its own size
    double pixels = 0, weight = 1;
};

/// The shortest interval that holds half of the values: dirt is on one side of a distribution and hardly moves it.
struct ShortestHalf {
    double middle, length;
};

ShortestHalf shortest_half(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    std::size_t first = 0;
    for (std::size_t k = 1; k + half < values.size(); ++k)
        if (values[k + half] - values[k] < values[first + half] - values[first]) first = k;
    double sum = 0;
    for (std::size_t k = first; k <= first + half; ++k) sum += values[k];
    return {sum / double(half + 1), values[first + half] - values[first]};
}

/// Rows: value in the middle, slopes along x and y; columns: channels.
Eigen::Matrix3d fit_plane(const std::vector<Block>& blocks) {
    Eigen::Matrix3d normal = 1e-12 * Eigen::Matrix3d::Identity(), right = Eigen::Matrix3d::Zero();
    for (const Block& block : blocks) {
        const Eigen::Vector3d basis(1, block.x, block.y);
        const double weight = block.weight * block.pixels;
        normal += weight * basis * basis.transpose();
        right += weight * basis * block.value.transpose();
    }
    return normal.ldlt().solve(right);
}

Eigen::Vector3d off_plane(const Block& block, const Eigen::Matrix3d& plane) {
    return block.value - plane.transpose() * Eigen::Vector3d(1, block.x, block.y);
}

void reweigh(std::vector<Block>& blocks, const Eigen::Matrix3d& plane) {
    constexpr double tukey = 4.685, to_deviation = 0.7413;  // 95 % efficient; the shortest half of a normal one
    Eigen::Vector3d scale;
    for (int channel = 0; channel < 3; ++channel) {
        std::vector<double> off;
        for (const Block& block : blocks) off.push_back(off_plane(block, plane)[channel]);
        scale[channel] = std::max(to_deviation * shortest_half(std::move(off)).length, 1e-9);
    }
    for (Block& block : blocks) {
        const double worst = (off_plane(block, plane).array().abs() / scale.array()).maxCoeff() / tukey;
        block.weight = worst < 1 ? std::pow(1 - worst * worst, 2) : 0;
    }
}

/// Mean of a normal distribution over the mean of it cut off at 0, given the share below 0.
double uncut_share(double below) {
    if (below <= 0) return 1;
    if (below >= 0.5) return 0;
    double low = 0, high = 10;  // mean in standard deviations, by bisection
    for (int step = 0; step < 60; ++step) {
        const double t = 0.5 * (low + high);
        (0.5 * std::erfc(t / std::numbers::sqrt2) > below ? low : high) = t;
    }
    const double t = low, density = std::exp(-0.5 * t * t) / std::sqrt(2 * std::numbers::pi);
    return t / (density + t * (1 - below));
}

}  // namespace

AreaSample sample_area(const io::Photograph& photo, const Rectification& place, const Area& area,
                       const Eigen::Vector3d& clip) {
    AreaSample sample;
    sample.middle_px = place.to_px(area.center());
    Eigen::Vector2d low = Eigen::Vector2d::Constant(1e30), high = -low;
    for (const double x : {area.min_mm.x(), area.max_mm.x()})
        for (const double y : {area.min_mm.y(), area.max_mm.y()}) {
            const Eigen::Vector2d p = place.to_px({x, y});
            low = low.cwiseMin(p);
            high = high.cwiseMax(p);
        }
    if (!(low.x() >= 0 && low.y() >= 0 && high.x() <= photo.width_px && high.y() <= photo.height_px)) return sample;
    const double edge_px = place.px_per_unit(area.center()) * std::sqrt(area.size().prod());
    constexpr double least_edge_px = 9, px_per_block = 3;
    if (edge_px < least_edge_px) return sample;
    const int n = std::clamp(int(edge_px / px_per_block), 3, 20);
    std::vector<Block> grid(std::size_t(n) * std::size_t(n));
    for (auto y = std::uint32_t(low.y()); y < std::min<double>(photo.height_px, high.y()); ++y)
        for (auto x = std::uint32_t(low.x()); x < std::min<double>(photo.width_px, high.x()); ++x) {
            const Eigen::Vector2d own = (place.from_px({x + 0.5, y + 0.5}) - area.min_mm).cwiseQuotient(area.size());
            if (!(own.x() >= 0 && own.y() >= 0 && own.x() < 1 && own.y() < 1)) continue;
            const Eigen::Vector3d value = photo.pixels[photo.index(x, y)].cast<double>();
            Block& block = grid[std::size_t(int(own.y() * n) * n + int(own.x() * n))];
            block.value += value;
            block.x += own.x() - 0.5;
            block.y += own.y() - 0.5;
            ++block.pixels;
            ++sample.pixels;
            sample.at_zero += (value.array() <= 0).cast<double>().matrix();
            sample.clipped += (value.array() >= clip.array()).cast<double>().matrix();
        }
    sample.clipped /= double(std::max<std::size_t>(sample.pixels, 1));
    sample.at_zero /= double(std::max<std::size_t>(sample.pixels, 1));
    std::vector<Block> blocks;
    for (Block& block : grid) {
        if (block.pixels == 0) continue;
        block.value /= block.pixels;
        block.x /= block.pixels;
        block.y /= block.pixels;
        blocks.push_back(block);
    }
    // From the shortest halves: an area half of dirt would pull a first plane away.
    Eigen::Matrix3d plane = Eigen::Matrix3d::Zero();
    for (int channel = 0; channel < 3; ++channel) {
        std::vector<double> values;
        for (const Block& block : blocks) values.push_back(block.value[channel]);
        plane(0, channel) = shortest_half(std::move(values)).middle;
    }
    constexpr int rounds = 15;
    for (int round = 0; round < rounds; ++round) {
        reweigh(blocks, plane);
        plane = fit_plane(blocks);
    }
    double weight = 0, weight2 = 0;
    Eigen::Vector3d square = Eigen::Vector3d::Zero();
    std::size_t rejected = 0;
    for (const Block& block : blocks) {
        const double w = block.weight * block.pixels;
        weight += w;
        weight2 += w * w;
        square += w * off_plane(block, plane).cwiseAbs2();
        rejected += block.weight < 0.05;
    }
    sample.mean = plane.row(0).transpose();
    sample.spread = (square / weight).cwiseSqrt();
    sample.rejected = double(rejected) / double(blocks.size());
    // Dirt that is too little to be found as such pulls the mean to one side; the middle of the shortest half moves
    // less. By itself that wanders by some n^(-1/3) of the spread, which is nothing to go by.
    const double wander = 1.5 / std::cbrt(double(blocks.size()));
    for (int channel = 0; channel < 3; ++channel) {
        std::vector<double> off;
        for (const Block& block : blocks) off.push_back(off_plane(block, plane)[channel]);
        const double pull = shortest_half(std::move(off)).middle, chance = wander * sample.spread[channel];
        // What is fainter than twice the spread is not found at all: it is allowed to cover some percent of the area.
        const double undetected = 0.15 * sample.spread[channel];
        sample.error[channel] = std::sqrt(std::pow(sample.spread[channel], 2) * weight2 / (weight * weight) +
                                          std::max(0.0, pull * pull - chance * chance) + undetected * undetected);
    }
    for (int channel = 0; channel < 3; ++channel)
        sample.zero_excess[channel] = std::max(0.0, sample.mean[channel]) * (1 - uncut_share(sample.at_zero[channel]));
    sample.complete = true;
    return sample;
}

Eigen::Vector3d clipping_level(const io::Photograph& photo) {
    if (photo.bits < 32)
        return Eigen::Vector3d::Constant(photo.bits == 8 ? 0.99 : 0.996);  // of 8 bits: a code less than the largest
    Eigen::Vector3f most = Eigen::Vector3f::Zero();
    for (const Eigen::Vector3f& pixel : photo.pixels) most = most.cwiseMax(pixel);
    Eigen::Vector3d level;
    for (int channel = 0; channel < 3; ++channel) {
        std::size_t there = 0;
        for (const Eigen::Vector3f& pixel : photo.pixels) there += pixel[channel] >= most[channel] * 0.9999f;
        level[channel] = there > std::max<std::size_t>(20, photo.pixels.size() / 10000)
                             ? most[channel] * 0.999
                             : std::numeric_limits<double>::infinity();
    }
    return level;
}

}  // namespace voxtone::calibration

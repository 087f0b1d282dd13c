// SPDX-License-Identifier: GPL-3.0-or-later
#include "gratings.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Cholesky>

namespace voxtone::loop_benchmark {
namespace {

constexpr double margin_mm = 0.4;
constexpr double around = 0.4;  // linear light between and around the blocks is their mean; of mid contrast

double phase(const GratingBlock& b, double x, double y) {
    return 2 * std::numbers::pi * b.per_mm * (b.axis == 0 ? x - 0.5 * (b.x0 + b.x1) : y - 0.5 * (b.y0 + b.y1));
}

double luminance(const Eigen::Vector3f& c) {
    return 0.2126 * static_cast<double>(c[0]) + 0.7152 * static_cast<double>(c[1]) + 0.0722 * static_cast<double>(c[2]);
}

}  // namespace

std::vector<GratingBlock> grating_blocks(double width_mm, double height_mm) {
    std::vector<GratingBlock> blocks;
    for (std::size_t f = 0; f < 3; ++f)
        for (int row = 0; row < 4; ++row)
            blocks.push_back({width_mm * static_cast<double>(f) / 3, height_mm * row / 4,
                              width_mm * static_cast<double>(f + 1) / 3, height_mm * (row + 1) / 4,
                              grating_frequencies[f], row % 2, row >= 2});
    return blocks;
}

double grating_light(std::span<const GratingBlock> blocks, double x, double y) {
    for (const GratingBlock& b : blocks)
        if (x >= b.x0 && x < b.x1 && y >= b.y0 && y < b.y1)
            return (b.full ? 0.5 : around) + (b.full ? 0.48 : 0.15) * std::cos(phase(b, x, y));
    return around;
}

double modulation_kept(const GratingBlock& block, const optics::Surface& surface,
                       std::span<const Eigen::Vector3f> target, std::span<const Eigen::Vector3f> print) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right_target = Eigen::Vector3d::Zero(), right_print = Eigen::Vector3d::Zero();
    int cells = 0;
    const double x0 = block.x0 + margin_mm, x1 = block.x1 - margin_mm, y0 = block.y0 + margin_mm,
                 y1 = block.y1 - margin_mm;
    if ((block.axis == 0 ? x1 - x0 : y1 - y0) < 1 / block.per_mm) return std::numeric_limits<double>::quiet_NaN();
    for (std::size_t i = 0; i < surface.cells.size(); ++i) {
        const double x = static_cast<double>(surface.cells[i].centre_mm[0]),
                     y = static_cast<double>(surface.cells[i].centre_mm[1]);
        if (x < x0 || x > x1 || y < y0 || y > y1) continue;
        const Eigen::Vector3d basis(1, std::cos(phase(block, x, y)), std::sin(phase(block, x, y)));
        normal += basis * basis.transpose();
        right_target += basis * luminance(target[i]);
        right_print += basis * luminance(print[i]);
        ++cells;
    }
    if (cells < 30) return std::numeric_limits<double>::quiet_NaN();
    const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
    const Eigen::Vector3d t = solver.solve(right_target), p = solver.solve(right_print);
    const double in_phase = (p[1] * t[1] + p[2] * t[2]) / (t[1] * t[1] + t[2] * t[2]);
    return in_phase * t[0] / p[0];
}

std::array<double, 3> modulation_by_frequency(double width_mm, double height_mm, const optics::Surface& surface,
                                              std::span<const Eigen::Vector3f> target,
                                              std::span<const Eigen::Vector3f> print) {
    std::array<double, 3> sum{}, kept{};
    std::array<int, 3> count{};
    for (const GratingBlock& b : grating_blocks(width_mm, height_mm)) {
        const double k = modulation_kept(b, surface, target, print);
        if (std::isnan(k)) continue;
        const std::size_t f = b.per_mm < 0.75 ? 0 : b.per_mm < 1.5 ? 1 : 2;
        sum[f] += k;
        ++count[f];
    }
    for (std::size_t f = 0; f < 3; ++f)
        kept[f] = count[f] ? sum[f] / count[f] : std::numeric_limits<double>::quiet_NaN();
    return kept;
}

}  // namespace voxtone::loop_benchmark

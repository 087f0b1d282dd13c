// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/compare/print_spread.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parallel.h"

namespace voxtone::calibration {

namespace {

std::vector<float> spread_kernel(double sigma) {
    if (sigma < 1e-3) return {1.0f};
    const auto ramp = [&](double x) {
        const double t = x / sigma;
        return x * 0.5 * std::erfc(-t / std::numbers::sqrt2) +
               sigma * std::exp(-0.5 * t * t) / std::sqrt(2 * std::numbers::pi);
    };
    const int reach = int(std::ceil(4 * sigma)) + 1;
    std::vector<float> kernel;
    for (int n = -reach; n <= reach; ++n) kernel.push_back(float(ramp(n + 1) - 2 * ramp(n) + ramp(n - 1)));
    return kernel;
}

/// What lies beyond the border is as its last cell.
std::vector<Eigen::Vector3f> along_axis(std::span<const Eigen::Vector3f> rgb, int columns, int rows, bool along_x,
                                        const std::vector<float>& kernel) {
    const int reach = int(kernel.size() / 2);
    std::vector<Eigen::Vector3f> out(rgb.size());
    parallel_for(0, std::size_t(rows), 8, [&](std::size_t y) {
        for (int x = 0; x < columns; ++x) {
            Eigen::Vector3f sum = Eigen::Vector3f::Zero();
            for (int n = -reach; n <= reach; ++n) {
                const int u = along_x ? std::clamp(x + n, 0, columns - 1) : x,
                          v = along_x ? int(y) : std::clamp(int(y) + n, 0, rows - 1);
                sum += kernel[std::size_t(n + reach)] * rgb[std::size_t(v) * std::size_t(columns) + std::size_t(u)];
            }
            out[y * std::size_t(columns) + std::size_t(x)] = sum;
        }
    });
    return out;
}

}  // namespace

std::vector<Eigen::Vector3f> spread_cells(std::span<const Eigen::Vector3f> rgb, int columns,
                                          const Eigen::Vector2d& sigma_cells) {
    const int rows = int(rgb.size() / std::size_t(columns));
    const auto wide = along_axis(rgb, columns, rows, true, spread_kernel(sigma_cells.x()));
    return along_axis(wide, columns, rows, false, spread_kernel(sigma_cells.y()));
}

double fitted_spread_mm(std::span<const Eigen::Vector3f> predicted, std::span<const Eigen::Vector3f> seen,
                        std::span<const std::uint8_t> counts, int columns, const Eigen::Vector2d& cell_mm) {
    const auto misfit = [&](double sigma_mm) {
        const auto spread = spread_cells(predicted, columns, sigma_mm * cell_mm.cwiseInverse());
        double sum = 0;
        for (std::size_t i = 0; i < spread.size(); ++i)
            if (counts[i]) {
                const Eigen::Array3f off =
                    (seen[i] - spread[i]).array() / (predicted[i].array().max(0.0f) + 0.05f).sqrt();
                sum += double((off * off).sum());
            }
        return sum;
    };
    // The misfit has one valley; a golden section closes in on it.
    constexpr double most_mm = 0.5, enough_mm = 0.001, golden = 0.6180339887498949;
    double low = 0, high = most_mm;
    double a = high - golden * (high - low), b = low + golden * (high - low);
    double at_a = misfit(a), at_b = misfit(b);
    while (high - low > enough_mm)
        if (at_a < at_b) {
            high = b, b = a, at_b = at_a;
            a = high - golden * (high - low), at_a = misfit(a);
        } else {
            low = a, a = b, at_a = at_b;
            b = low + golden * (high - low), at_b = misfit(b);
        }
    const double best = (low + high) / 2;
    return misfit(0) <= misfit(best) ? 0 : best;
}

}  // namespace voxtone::calibration

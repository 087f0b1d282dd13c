// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/print/cell_waves.h"

#include <cmath>
#include <numbers>

#include "scattering/local_profiles/profile_reconstruction.h"
#include "scattering/local_profiles/profile_rings.h"

namespace voxtone::scattering {

double left_by_cells(double k, double cell_mm) {
    constexpr int directions = 32;
    const auto square = [&](double along) {
        const double x = std::numbers::pi * k * cell_mm * along;
        return std::abs(x) < 1e-9 ? 1.0 : std::sin(x) / x * (std::sin(x) / x);
    };
    double sum = 0;
    for (int d = 0; d < directions; ++d) {
        const double angle = std::numbers::pi / 2 * (d + 0.5) / directions;
        sum += square(std::cos(angle)) * square(std::sin(angle));
    }
    return sum / directions;
}

std::vector<double> waves_behind_cells(std::span<const double> P, double cell_mm, const optics::HankelGrid& grid) {
    const auto rings = profile_rings(static_cast<std::uint32_t>(P.size() - 1));
    const std::vector<double> light = light_by_ring(P, rings, cell_mm);
    std::vector<double> waves;
    for (const double k : grid.k()) {
        double sum = 0;
        for (std::size_t i = 0; i < rings.size(); ++i)
            sum += light[i] * ::j0(2 * std::numbers::pi * k * rings[i].radius * cell_mm);
        waves.push_back(sum / left_by_cells(k, cell_mm));
    }
    return waves;
}

}  // namespace voxtone::scattering

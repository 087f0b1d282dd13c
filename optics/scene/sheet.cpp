// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/scene/sheet.h"

#include <algorithm>
#include <cmath>

#include "optics/numerics/quadrature.h"
#include "optics/scene/fresnel.h"

namespace voxtone::optics {

float Sheet::at(double x_mm, double y_mm, std::size_t channel) const {
    std::array<std::size_t, 2> cell{};
    const std::array<double, 2> place{x_mm, y_mm};
    for (std::size_t a = 0; a < 2; ++a) {
        const double k = std::floor((place[a] - corner_mm[a]) / cell_mm[a]);
        cell[a] = static_cast<std::size_t>(std::clamp(k, 0.0, cells[a] - 1.0));
    }
    return reflectance[(cell[1] * static_cast<std::size_t>(cells[0]) + cell[0]) * channels + channel];
}

double Sheet::mean(std::size_t channel) const {
    double sum = 0;
    for (std::size_t i = channel; i < reflectance.size(); i += channels) sum += static_cast<double>(reflectance[i]);
    return sum * static_cast<double>(channels) / static_cast<double>(reflectance.size());
}

double reflectance_in_air(double eta) {
    static const Rule rule = gauss_legendre(32, 0, 1);
    double rho = 0;  // the cosine squared is even in [0, 1]
    for (std::size_t i = 0; i < rule.x.size(); ++i) rho += rule.w[i] * fresnel_reflectance(std::sqrt(rule.x[i]), eta);
    return rho;
}

}  // namespace voxtone::optics

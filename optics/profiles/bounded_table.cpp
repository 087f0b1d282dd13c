// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/profiles/bounded_table.h"

#include <algorithm>
#include <cmath>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/profiles/saunderson.h"

namespace voxtone::optics {
namespace {

constexpr int table_samples = 33, table_directions = 16;

}  // namespace

BoundedTable::BoundedTable(double g, double eta, double most_tau, const Progress* progress)
    : turned_back_(internal_diffuse_reflectance(eta)) {
    VOXTONE_EXPECT(most_tau > 0 && std::isfinite(most_tau));
    Eigen::MatrixXd R_top(table_samples, table_samples), lost_down(table_samples, table_samples),
        R_bottom(table_samples, table_samples);
    const double most_x = std::sqrt(most_tau);
    parallel_for(
        0, table_samples * table_samples, 1,
        [&](std::size_t sample) {
            const auto i = static_cast<Eigen::Index>(sample) / table_samples,
                       j = static_cast<Eigen::Index>(sample) % table_samples;
            const double x = most_x * static_cast<double>(i) / (table_samples - 1),
                         y = static_cast<double>(j) / (table_samples - 1);
            const double tau = x * x;
            BoundedTotals at{0, 1, turned_back_, 1 - turned_back_};  // no layer
            if (tau > 0) at = bounded_totals({tau * y * y, tau * (1 - y * y)}, g, eta, 1.0, table_directions);
            R_top(i, j) = at.R_top;
            R_bottom(i, j) = at.R_bottom;
            lost_down(i, j) = y > 0 ? 1 - at.T_down / (1 - at.R_top) : 0;
        },
        progress);
    R_top_ = BicubicTable(R_top, most_x, 1);
    lost_down_ = BicubicTable(lost_down, most_x, 1);
    R_bottom_ = BicubicTable(R_bottom, most_x, 1);
}

BoundedTotals BoundedTable::at(double absorption, double scattering) const {
    const double tau = absorption + scattering;
    const double x = std::sqrt(tau), y = tau > 0 ? std::sqrt(std::clamp(absorption / tau, 0.0, 1.0)) : 0;
    BoundedTotals at;
    at.R_top = std::clamp(R_top_(x, y), 0.0, 1.0);
    at.T_down = (1 - at.R_top) * (1 - std::clamp(lost_down_(x, y), 0.0, 1.0));
    at.T_up = (1 - turned_back_) * at.T_down;
    at.R_bottom = std::clamp(R_bottom_(x, y), 0.0, 1 - at.T_up);
    if (absorption == 0) at.R_bottom = 1 - at.T_up;
    return at;
}

}  // namespace voxtone::optics

// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/colour/cie_tables.h"

#include <algorithm>

#include "base/contracts.h"

namespace voxtone::optics::cie {

Eigen::Matrix3Xd xyz_weights(std::span<const double> wavelengths_nm, const std::array<double, samples>& power) {
    VOXTONE_EXPECT(!wavelengths_nm.empty() && std::is_sorted(wavelengths_nm.begin(), wavelengths_nm.end()));
    Eigen::Matrix3Xd weights = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(wavelengths_nm.size()));
    double white = 0;
    for (std::size_t k = 0; k < samples; ++k) {
        const double nm = first_nm + step_nm * static_cast<double>(k);
        const Eigen::Vector3d response = power[k] * Eigen::Vector3d(xbar[k], ybar[k], zbar[k]);
        white += response[1];
        const auto next = std::upper_bound(wavelengths_nm.begin(), wavelengths_nm.end(), nm) - wavelengths_nm.begin();
        if (next == 0) {
            weights.col(0) += response;
        } else if (next == weights.cols()) {
            weights.col(next - 1) += response;
        } else {
            const double left = wavelengths_nm[static_cast<std::size_t>(next - 1)];
            const double t = (nm - left) / (wavelengths_nm[static_cast<std::size_t>(next)] - left);
            weights.col(next - 1) += (1 - t) * response;
            weights.col(next) += t * response;
        }
    }
    return weights / white;
}

}  // namespace voxtone::optics::cie

// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/chart_lengths.h"

#include <fmt/format.h>

#include "base/error.h"
#include "optics/colour/channels.h"

namespace voxtone::calibration {

std::vector<double> white_scattering(const optics::Channels& channels, double g, const optics::ResinSet& from) {
    const int white = from.find("W");
    if (white < 0)
        throw InputError(fmt::format(
            "Resin set \"{}\" has no white resin W, whose scattering would give lengths; name a set that has one.",
            from.name));
    const optics::Resin& resin = from.resins[static_cast<std::size_t>(white)];
    // How much of R, G and B a channel carries; negative weights are light that it takes from another one.
    const Eigen::Matrix3Xd mine = optics::linear_srgb_weights(channels).cwiseMax(0);
    const Eigen::Matrix3Xd theirs = optics::linear_srgb_weights(from.channels).cwiseMax(0);
    const Eigen::MatrixXd shared = mine.transpose() * theirs;
    std::vector<double> scattering;
    for (Eigen::Index c = 0; c < shared.rows(); ++c) {
        double sum = 0, weight = 0;
        for (Eigen::Index k = 0; k < shared.cols(); ++k) {
            sum += shared(c, k) * resin.medium(static_cast<std::size_t>(k)).sigma_s * (1 - from.g);
            weight += shared(c, k);
        }
        scattering.push_back(weight > 0 ? sum / weight / (1 - g) : resin.medium(0).sigma_s);
    }
    return scattering;
}

}  // namespace voxtone::calibration

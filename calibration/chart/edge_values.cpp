// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/edge_values.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "base/contracts.h"

namespace voxtone::calibration {

namespace {

constexpr double least_v_error = 0.02, least_ln_error = 0.1;
// What a channel of edges sees of a resin may be less than nothing: no light tells a length.
constexpr double least_rho_seen = 0.01;

// The v of a thick piece that reflects rho: by halving.
double v_of_reflectance(double rho, double g, const optics::HalfSpaceReflectance& reflectance) {
    double white = 0, black = 1;
    for (int step = 0; step < 40; ++step) {
        const double middle = (white + black) / 2, albedo = albedo_of_v(middle, g);
        (reflectance({1 - albedo, albedo}) > rho ? white : black) = middle;
    }
    return (white + black) / 2;
}

Eigen::Matrix2d broadened(const PriorValue& value) {
    const bool v = value.precision(0, 0) > 0, ln = value.precision(1, 1) > 0;
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
    if (v && ln)
        covariance = value.precision.inverse();
    else if (v)
        covariance(0, 0) = 1 / value.precision(0, 0);
    else if (ln)
        covariance(1, 1) = 1 / value.precision(1, 1);
    covariance.diagonal() += Eigen::Vector2d(least_v_error * least_v_error, least_ln_error * least_ln_error);
    return prior_precision(covariance, v, ln);
}

}  // namespace

std::vector<EdgePriorValue> edge_values(const ResinPrior& prior, const std::vector<std::string>& roles) {
    std::vector<EdgePriorValue> values;
    for (std::size_t r = 0; r < roles.size(); ++r) {
        const ResinPrior::Resin* resin = prior.find(roles[r]);
        for (std::size_t c = 0; resin && c < resin->channel.size(); ++c) {
            if (resin->channel[c].known() == 0) continue;
            EdgePriorValue& value = values.emplace_back(
                EdgePriorValue{static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c), resin->channel[c]});
            value.value.precision = broadened(resin->channel[c]);
        }
    }
    return values;
}

Eigen::VectorXd edge_residuals(const std::vector<EdgePriorValue>& values, const ObserverModel& model,
                               const ObserverParts& parts, optics::Illuminant illuminant) {
    const Eigen::Index channels = model.channels();
    VOXTONE_EXPECT(values.empty() || parts.scattering.size() == channels);
    const Eigen::Vector3d white = optics::colorimetric_white(illuminant);
    const Eigen::Matrix3Xd seen = optics::linear_srgb_of(white) * white.asDiagonal() * parts.weights.transpose();
    const double g = model.options().g;
    Eigen::VectorXd residuals(2 * static_cast<Eigen::Index>(values.size()));
    for (std::size_t i = 0; i < values.size(); ++i) {
        const EdgePriorValue& of = values[i];
        double rho = 0, ln_sigma_t = 0;
        for (Eigen::Index c = 0; c < channels; ++c) {
            const optics::Medium medium{parts.scattering[c] * parts.a(of.resin, c),
                                        parts.scattering[c] * parts.s(of.resin, c)};
            const double part = seen(of.channel, c) * model.reflectance()(medium);
            rho += part, ln_sigma_t += part * std::log(medium.sigma_t());
        }
        rho = std::max(rho, least_rho_seen);
        const Eigen::Vector2d off(v_of_reflectance(rho, g, model.reflectance()) - of.value.at.v,
                                  ln_sigma_t / rho - of.value.at.ln_sigma_t);
        // Known halves alone make a precision that is half zero: the root of each then.
        const Eigen::Matrix2d& precision = of.value.precision;
        const Eigen::Matrix2d root = of.value.known() == 2
                                         ? Eigen::Matrix2d(precision.llt().matrixL().transpose())
                                         : Eigen::Matrix2d(precision.diagonal().cwiseSqrt().asDiagonal());
        residuals.segment<2>(2 * static_cast<Eigen::Index>(i)) = root * off;
    }
    return residuals;
}

std::vector<std::string> edge_disagreements(const std::vector<EdgePriorValue>& values, const Eigen::VectorXd& residuals,
                                            const std::vector<std::string>& roles) {
    constexpr double one_value = 10.83, two_values = 13.82;  // chi^2 exceeded once in a thousand times
    std::vector<std::string> sentences;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double chi2 = residuals.segment<2>(2 * static_cast<Eigen::Index>(i)).squaredNorm();
        if (chi2 > (values[i].value.known() == 2 ? two_values : one_value))
            sentences.push_back(fmt::format(
                "{} in {}: the chart and the edges disagree, by {:.1f} standard errors; which is wrong they do not say",
                roles[static_cast<std::size_t>(values[i].resin)], "RGB"[values[i].channel], std::sqrt(chi2)));
    }
    return sentences;
}

}  // namespace voxtone::calibration

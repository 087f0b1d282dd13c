// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/observer_model.h"

#include <algorithm>
#include <cmath>

#include "base/contracts.h"

namespace voxtone::calibration {

namespace {

// A surface of resin throws back 4 %; more is no surface.
constexpr double most_surface = 0.05;

// An instrument's white is a perfect diffuser's within a tenth. Left free, the gain takes a part of what absorption
// does: colours are as good, but white would carry light less far than its reflectance says.
constexpr double gain_range = 0.1;

constexpr double least_spread = 1e-3;
// Nothing is known of it beforehand: all it can be lies within what the ridge hardly feels.
constexpr double spread_scale = 10;

double logistic(double x) { return 1 / (1 + std::exp(-x)); }

}  // namespace

void read_observer(const Eigen::Ref<const Eigen::VectorXd>& unknowns, ObserverParts& parts) {
    Eigen::Index at = 0;
    if (unknowns.size() > 2) {
        for (Eigen::Index c = 0; c < parts.weights.rows(); ++c)
            for (Eigen::Index k = 0; k < 3; ++k) parts.weights(c, k) = std::exp(unknowns[at++]);
        for (Eigen::Index k = 0; k < 3; ++k) parts.weights.col(k) /= parts.weights.col(k).sum();
    }
    parts.surface = most_surface * logistic(unknowns[at++]);
    parts.gain = 1 + gain_range * std::tanh(unknowns[at]);
}

Eigen::VectorXd observer_unknowns(const ObserverParts& parts, bool with_weights) {
    Eigen::VectorXd unknowns((with_weights ? 3 * parts.weights.rows() : 0) + 2);
    Eigen::Index at = 0;
    for (Eigen::Index c = 0; with_weights && c < parts.weights.rows(); ++c)
        for (Eigen::Index k = 0; k < 3; ++k) unknowns[at++] = std::log(parts.weights(c, k));
    unknowns[at++] = std::log(parts.surface / (most_surface - parts.surface));
    unknowns[at] = std::atanh((parts.gain - 1) / gain_range);
    return unknowns;
}

void add_observer_derivatives(const ObserverParts& parts, const Eigen::VectorXd& seen,
                              Eigen::Ref<Eigen::Matrix3Xd> by_unknown) {
    const Eigen::Vector3d colour = parts.weights.transpose() * seen;
    Eigen::Index at = 0;
    for (Eigen::Index c = 0; by_unknown.cols() > 2 && c < parts.weights.rows(); ++c)
        for (Eigen::Index k = 0; k < 3; ++k) {
            by_unknown.col(at).setZero();
            by_unknown(k, at++) = parts.weights(c, k) * (seen[c] - colour[k]);
        }
    by_unknown.col(at++).setConstant(parts.gain * parts.surface * (1 - parts.surface / most_surface));
    const double towards_end = (parts.gain - 1) / gain_range;
    by_unknown.col(at) = gain_range * (1 - towards_end * towards_end) / parts.gain * colour;
}

optics::ResinSet set_of_parts(const std::vector<std::string>& roles, const ObserverParts& parts,
                              optics::Illuminant illuminant) {
    optics::ResinSet set;
    set.dot_spread = parts.dot_spread;
    set.channels.illuminant = illuminant;
    const Eigen::Vector3d white = optics::colorimetric_white(illuminant);
    for (Eigen::Index c = 0; c < parts.weights.rows(); ++c) {
        const Eigen::Vector3d xyz = parts.weights.row(c).transpose().cwiseProduct(white);
        set.channels.xyz.push_back({xyz[0], xyz[1], xyz[2]});
    }
    for (std::size_t r = 0; r < roles.size(); ++r) {
        optics::Resin& resin = set.resins.emplace_back(optics::Resin{roles[r], roles[r], {}, {}});
        for (Eigen::Index c = 0; c < parts.weights.rows(); ++c) {
            const double s = parts.s(static_cast<Eigen::Index>(r), c),
                         sum = parts.a(static_cast<Eigen::Index>(r), c) + s;
            resin.sigma_t_per_mm.push_back(parts.scattering.size() > 0 ? parts.scattering[c] * sum : sum);
            resin.albedo.push_back(s / sum);
        }
    }
    set.measured.surface = parts.surface, set.measured.gain = parts.gain;
    return set;
}

ObserverModel::ObserverModel(Eigen::Index resins, Eigen::Index white, Eigen::Index channels,
                             const ObserverModelOptions& options)
    : resins_(resins),
      white_(white),
      channels_(channels),
      options_(options),
      reflectance_(options.g, options.eta, options.geometry) {
    VOXTONE_EXPECT(resins > 0 && white >= 0 && white <= resins && channels >= 3);
}

Eigen::Index ObserverModel::scattering_at(Eigen::Index resin, Eigen::Index channel) const {
    VOXTONE_EXPECT(!is_white(resin));
    return (resins_ + resin - (resin > white_ ? 1 : 0)) * channels_ + channel;
}

double ObserverModel::spread_by_unknown(const ObserverParts& parts) {
    return spread_scale * parts.dot_spread * (1 - parts.dot_spread);
}

ObserverParts ObserverModel::parts(const Eigen::VectorXd& unknowns, const ObserverParts& known) const {
    VOXTONE_EXPECT(unknowns.size() == this->unknowns());
    ObserverParts parts;
    parts.a.resize(resins_, channels_), parts.s.setOnes(resins_, channels_), parts.weights.resize(channels_, 3);
    for (Eigen::Index r = 0; r < resins_; ++r)
        for (Eigen::Index c = 0; c < channels_; ++c) {
            parts.a(r, c) = std::exp(unknowns[absorption_at(r, c)]);
            if (!is_white(r)) parts.s(r, c) = std::exp(unknowns[scattering_at(r, c)]);
        }
    parts.scattering = known.scattering, parts.dot_spread = known.dot_spread;
    if (options_.known_observer) parts.weights = known.weights;
    if (options_.lengths) parts.scattering = unknowns.segment(length_at(0), channels_).array().exp();
    if (fits_spread()) parts.dot_spread = logistic(spread_scale * unknowns[spread_at()]);
    read_observer(unknowns.tail(unknowns.size() - observer_at()), parts);
    return parts;
}

Eigen::VectorXd ObserverModel::unknowns_of(const ObserverParts& parts) const {
    Eigen::VectorXd unknowns(this->unknowns());
    for (Eigen::Index r = 0; r < resins_; ++r)
        for (Eigen::Index c = 0; c < channels_; ++c) {
            unknowns[absorption_at(r, c)] = std::log(parts.a(r, c));
            if (!is_white(r)) unknowns[scattering_at(r, c)] = std::log(parts.s(r, c));
        }
    if (options_.lengths) unknowns.segment(length_at(0), channels_) = parts.scattering.array().log();
    if (fits_spread()) {
        const double spread = std::clamp(parts.dot_spread, least_spread, 1 - least_spread);
        unknowns[spread_at()] = std::log(spread / (1 - spread)) / spread_scale;
    }
    unknowns.tail(unknowns.size() - observer_at()) = observer_unknowns(parts, !options_.known_observer);
    return unknowns;
}

optics::EffectiveMedium ObserverModel::law(const ObserverParts& parts) const {
    VOXTONE_EXPECT(!fits_spread() || parts.scattering.size() == channels_);
    optics::ResinSet set = set_of_parts(std::vector<std::string>(static_cast<std::size_t>(resins_)), parts, {});
    set.g = options_.g;
    return {set, options_.pitch_mm};
}

Eigen::MatrixX3d ObserverModel::colours(const ObserverParts& parts, const Eigen::MatrixXd& shares) const {
    const optics::EffectiveMedium law = this->law(parts);
    Eigen::MatrixXd seen(shares.rows(), channels_);
    for (Eigen::Index i = 0; i < seen.rows(); ++i) {
        const Eigen::VectorXd of = shares.row(i).transpose();
        const std::span<const double> fractions{of.data(), static_cast<std::size_t>(of.size())};
        for (Eigen::Index c = 0; c < channels_; ++c)
            seen(i, c) = parts.gain * (parts.surface + reflectance_(law(fractions, static_cast<std::size_t>(c))));
    }
    return seen * parts.weights;
}

Eigen::Vector3d ObserverModel::colour(const ObserverParts& parts, const optics::EffectiveMedium& law,
                                      const Eigen::RowVectorXd& shares, Eigen::Ref<Eigen::Matrix3Xd> by_unknown) const {
    const std::span<const double> fractions{shares.data(), static_cast<std::size_t>(shares.size())};
    Eigen::VectorXd seen(channels_);
    optics::EffectiveMedium::ByResins by;
    if (fits_spread()) by_unknown.col(spread_at()).setZero();
    for (Eigen::Index c = 0; c < channels_; ++c) {
        const auto channel = static_cast<std::size_t>(c);
        const optics::EffectiveMedium::Point point = law.at(fractions, channel);
        law.by_resins(point, fractions, channel, by);
        const auto value = reflectance_.with_gradient(point.medium);
        seen[c] = parts.gain * (parts.surface + value.rho);
        const Eigen::Vector3d weight = parts.gain * parts.weights.row(c).transpose();
        const auto slope = [&](const optics::Medium& step) {
            return value.by_absorption * step.sigma_a + value.by_scattering * step.sigma_s;
        };
        for (Eigen::Index r = 0; r < resins_; ++r) {
            const auto resin = static_cast<std::size_t>(r);
            by_unknown.col(absorption_at(r, c)) = slope(by.by_absorption[resin]) * weight;
            if (!is_white(r)) by_unknown.col(scattering_at(r, c)) = slope(by.by_scattering[resin]) * weight;
        }
        // More of both makes thick pieces look no different; it makes voxels optically larger.
        if (options_.lengths) by_unknown.col(length_at(c)) = slope(by.by_chord) * weight;
        if (fits_spread())
            by_unknown.col(spread_at()) -=
                spread_by_unknown(parts) / (1 - parts.dot_spread) * slope(by.by_chord) * weight;
    }
    add_observer_derivatives(parts, seen, by_unknown.rightCols(by_unknown.cols() - observer_at()));
    return parts.weights.transpose() * seen;
}

}  // namespace voxtone::calibration

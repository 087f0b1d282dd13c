// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/calibration/chart/observer_model.h"

#include <cmath>

#include "voxtone/base/contracts.h"

namespace voxtone::calibration {

namespace {

// A surface of resin throws back 4 %; more is no surface.
constexpr double most_surface = 0.05;

// An instrument's white is a perfect diffuser's within a tenth. Left free, the gain takes a part of what absorption
// does: colours are as good, but white would carry light less far than its reflectance says.
constexpr double gain_range = 0.1;

// Order of the unknowns: ln a [resin][channel], ln s of all but white [resin][channel], ln w [channel][XYZ], surface,
// gain.
double logistic(double x) { return 1 / (1 + std::exp(-x)); }

}  // namespace

void read_observer(const Eigen::Ref<const Eigen::VectorXd>& unknowns, ObserverParts& parts) {
    Eigen::Index at = 0;
    for (Eigen::Index c = 0; c < parts.weights.rows(); ++c)
        for (Eigen::Index k = 0; k < 3; ++k) parts.weights(c, k) = std::exp(unknowns[at++]);
    for (Eigen::Index k = 0; k < 3; ++k) parts.weights.col(k) /= parts.weights.col(k).sum();
    parts.surface = most_surface * logistic(unknowns[at++]);
    parts.gain = 1 + gain_range * std::tanh(unknowns[at]);
}

Eigen::VectorXd observer_unknowns(const ObserverParts& parts) {
    Eigen::VectorXd unknowns(3 * parts.weights.rows() + 2);
    Eigen::Index at = 0;
    for (Eigen::Index c = 0; c < parts.weights.rows(); ++c)
        for (Eigen::Index k = 0; k < 3; ++k) unknowns[at++] = std::log(parts.weights(c, k));
    unknowns[at++] = std::log(parts.surface / (most_surface - parts.surface));
    unknowns[at] = std::atanh((parts.gain - 1) / gain_range);
    return unknowns;
}

void add_observer_derivatives(const ObserverParts& parts, const Eigen::VectorXd& seen,
                              Eigen::Ref<Eigen::Matrix3Xd> by_unknown) {
    const Eigen::Vector3d colour = parts.weights.transpose() * seen;
    Eigen::Index at = 0;
    for (Eigen::Index c = 0; c < parts.weights.rows(); ++c)
        for (Eigen::Index k = 0; k < 3; ++k) {
            by_unknown.col(at).setZero();
            by_unknown(k, at++) = parts.weights(c, k) * (seen[c] - colour[k]);
        }
    by_unknown.col(at++).setConstant(parts.gain * parts.surface * (1 - parts.surface / most_surface));
    const double towards_end = (parts.gain - 1) / gain_range;
    by_unknown.col(at) = gain_range * (1 - towards_end * towards_end) / parts.gain * colour;
}

ObserverModel::ObserverModel(Eigen::Index resins, Eigen::Index white, Eigen::Index channels, double g, double eta,
                             optics::MeasuringGeometry geometry)
    : resins_(resins), white_(white), channels_(channels), reflectance_(g, eta, geometry) {
    VOXTONE_EXPECT(resins > 0 && white >= 0 && white < resins && channels >= 3);
}

ObserverParts ObserverModel::parts(const Eigen::VectorXd& unknowns) const {
    VOXTONE_EXPECT(unknowns.size() == this->unknowns());
    ObserverParts parts;
    parts.a.resize(resins_, channels_), parts.s.setOnes(resins_, channels_), parts.weights.resize(channels_, 3);
    Eigen::Index at = 0;
    for (Eigen::Index r = 0; r < resins_; ++r)
        for (Eigen::Index c = 0; c < channels_; ++c) parts.a(r, c) = std::exp(unknowns[at++]);
    for (Eigen::Index r = 0; r < resins_; ++r)
        for (Eigen::Index c = 0; r != white_ && c < channels_; ++c) parts.s(r, c) = std::exp(unknowns[at++]);
    read_observer(unknowns.tail(unknowns.size() - at), parts);
    return parts;
}

Eigen::VectorXd ObserverModel::unknowns_of(const ObserverParts& parts) const {
    Eigen::VectorXd unknowns(this->unknowns());
    Eigen::Index at = 0;
    for (Eigen::Index r = 0; r < resins_; ++r)
        for (Eigen::Index c = 0; c < channels_; ++c) unknowns[at++] = std::log(parts.a(r, c));
    for (Eigen::Index r = 0; r < resins_; ++r)
        for (Eigen::Index c = 0; r != white_ && c < channels_; ++c) unknowns[at++] = std::log(parts.s(r, c));
    unknowns.tail(unknowns.size() - at) = observer_unknowns(parts);
    return unknowns;
}

Eigen::MatrixX3d ObserverModel::colours(const ObserverParts& parts, const Eigen::MatrixXd& shares) const {
    const Eigen::MatrixXd absorption = shares * parts.a, scattering = shares * parts.s;
    Eigen::MatrixXd seen(shares.rows(), channels_);
    for (Eigen::Index i = 0; i < seen.rows(); ++i)
        for (Eigen::Index c = 0; c < channels_; ++c)
            seen(i, c) = parts.gain * (parts.surface + reflectance_({absorption(i, c), scattering(i, c)}));
    return seen * parts.weights;
}

Eigen::Vector3d ObserverModel::colour(const ObserverParts& parts, const Eigen::RowVectorXd& shares,
                                      Eigen::Ref<Eigen::Matrix3Xd> by_unknown) const {
    const Eigen::RowVectorXd absorption = shares * parts.a, scattering = shares * parts.s;
    Eigen::VectorXd seen(channels_), by_absorption(channels_), by_scattering(channels_);
    for (Eigen::Index c = 0; c < channels_; ++c) {
        const auto value = reflectance_.with_gradient({absorption[c], scattering[c]});
        seen[c] = parts.gain * (parts.surface + value.rho);
        by_absorption[c] = parts.gain * value.by_absorption, by_scattering[c] = parts.gain * value.by_scattering;
    }
    const Eigen::Vector3d colour = parts.weights.transpose() * seen;
    Eigen::Index at = 0;
    for (Eigen::Index r = 0; r < resins_; ++r)
        for (Eigen::Index c = 0; c < channels_; ++c)
            by_unknown.col(at++) = by_absorption[c] * shares[r] * parts.a(r, c) * parts.weights.row(c).transpose();
    for (Eigen::Index r = 0; r < resins_; ++r)
        for (Eigen::Index c = 0; r != white_ && c < channels_; ++c)
            by_unknown.col(at++) = by_scattering[c] * shares[r] * parts.s(r, c) * parts.weights.row(c).transpose();
    add_observer_derivatives(parts, seen, by_unknown.rightCols(by_unknown.cols() - at));
    return colour;
}

}  // namespace voxtone::calibration

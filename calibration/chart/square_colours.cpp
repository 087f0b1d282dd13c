// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/square_colours.h"

#include "base/parallel.h"
#include "calibration/chart/colour_fit.h"

namespace voxtone::calibration {

SquareColours::SquareColours(const ThinSquares& squares, std::vector<std::string> roles, const ObserverModel& model)
    : squares_(squares), roles_(std::move(roles)), model_(model) {
    options_.g = model.options().g, options_.eta = model.options().eta, options_.pitch_mm = model.options().pitch_mm;
    if (!squares_.patches.empty()) plan_ = patch_plan(options_, squares_.patches.front().is_laminate());
}

void SquareColours::prepare(const ObserverParts& parts, bool with_derivatives) {
    parts_ = parts;
    const Eigen::Index squares = this->squares(), channels = model_.channels(), resins = model_.resins();
    rho_.resize(squares, channels);
    by_.assign(with_derivatives ? static_cast<std::size_t>(channels) : 0, {});
    if (squares == 0) return;
    options_.dot_spread = parts.dot_spread;
    const PatchModel model(squares_.patches, roles_, options_, plan_);
    parallel_for(0, static_cast<std::size_t>(channels), 1, [&](std::size_t channel) {
        const auto c = static_cast<Eigen::Index>(channel);
        std::vector<optics::Medium> media;
        for (Eigen::Index r = 0; r < resins; ++r)
            media.push_back({parts.scattering[c] * parts.a(r, c), parts.scattering[c] * parts.s(r, c)});
        std::vector<double> rho(static_cast<std::size_t>(squares));
        const PatchModel::Bases bases = model.bases(media, with_derivatives);
        if (with_derivatives) {
            model.evaluate(media, bases, rho, by_[channel]);
            for (Eigen::Index r = 0; r < resins; ++r) {
                by_[channel].col(2 * r) *= media[static_cast<std::size_t>(r)].sigma_a;
                by_[channel].col(2 * r + 1) *= media[static_cast<std::size_t>(r)].sigma_s;
            }
        } else {
            model.evaluate(media, bases, rho);
        }
        rho_.col(c) = Eigen::Map<const Eigen::VectorXd>(rho.data(), squares);
    });
}

Eigen::Vector3d SquareColours::colour(Eigen::Index square, Eigen::Ref<Eigen::Matrix3Xd> by_unknown) const {
    ObserverParts read = parts_;
    const bool own = squares_.own_instrument[static_cast<std::size_t>(square)];
    if (own) read.gain = 1, read.surface = 0;
    const Eigen::VectorXd seen = read.gain * (read.surface + rho_.row(square).transpose().array());
    const Eigen::Vector3d colour = read.weights.transpose() * seen;
    if (by_.empty()) return colour;
    if (model_.fits_spread()) by_unknown.col(model_.spread_at()).setZero();
    for (Eigen::Index c = 0; c < model_.channels(); ++c) {
        const Eigen::RowVectorXd by = by_[static_cast<std::size_t>(c)].row(square);
        const Eigen::Vector3d weight = read.gain * read.weights.row(c).transpose();
        for (Eigen::Index r = 0; r < model_.resins(); ++r) {
            by_unknown.col(model_.absorption_at(r, c)) = by[2 * r] * weight;
            if (!model_.is_white(r)) by_unknown.col(model_.scattering_at(r, c)) = by[2 * r + 1] * weight;
        }
        if (model_.options().lengths) by_unknown.col(model_.length_at(c)) = by.head(2 * model_.resins()).sum() * weight;
        if (model_.fits_spread())
            by_unknown.col(model_.spread_at()) -=
                ObserverModel::spread_by_unknown(parts_) / (1 - parts_.dot_spread) * by[2 * model_.resins()] * weight;
    }
    add_observer_derivatives(read, seen, by_unknown.rightCols(by_unknown.cols() - model_.observer_at()));
    if (own) by_unknown.rightCols<2>().setZero();
    return colour;
}

Eigen::MatrixX3d SquareColours::roots(const ObserverParts& parts) {
    prepare(parts, false);
    Eigen::MatrixX3d roots(squares(), 3);
    Eigen::Matrix3Xd unused(3, model_.unknowns());
    for (Eigen::Index i = 0; i < squares(); ++i) roots.row(i) = roots_of(colour(i, unused)).transpose();
    return roots;
}

}  // namespace voxtone::calibration

// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/layers/layer_model.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "calibration/chart/observer_start.h"
#include "optics/colour/colour.h"

namespace voxtone::calibration {

namespace {

// Of a logarithm: forward differences are wrong by 2e-4 of the slope; laws of layers carry noise of some 1e-9.
constexpr double log_step = 3e-4;
constexpr double usual_scattering_per_mm = 10;

// How much of a resin a laminate shows: its share of the layers above the base, the uppermost counting once more.
double shown_of(const LayerLaminate& laminate, std::size_t resin) {
    double sum = 0, of = 0;
    for (std::size_t k = 0; k + 1 < laminate.size() || k == 0; ++k) {
        const double counts = k == 0 ? 2 : 1;
        sum += counts;
        if (laminate[k].resin == resin) of += counts;
    }
    return of / sum;
}

}  // namespace

ObserverParts layer_start(const LayerChart& chart, Eigen::Index channels) {
    const auto resins = static_cast<Eigen::Index>(chart.roles.size());
    const Eigen::Vector3d white = optics::colorimetric_white(chart.illuminant);
    ObserverParts start;
    start.weights = start_weights(channels);
    start.s.setConstant(resins, channels, usual_scattering_per_mm);
    start.a.resize(resins, channels);
    for (Eigen::Index r = 0; r < resins; ++r) {
        const auto resin = static_cast<std::size_t>(r);
        const auto most = std::ranges::max_element(
            chart.laminates, {}, [&](const LayerLaminate& laminate) { return shown_of(laminate, resin); });
        const Eigen::Vector3d lab = chart.lab.row(most - chart.laminates.begin()).transpose();
        for (Eigen::Index c = 0; c < channels; ++c)
            start.a(r, c) = usual_scattering_per_mm * absorption_by_colour(lab, white, start_nm(c, channels));
    }
    start.surface = 0.015, start.gain = 1;
    return start;
}

LayerModel::LayerModel(const LayerChart& chart, Eigen::Index channels, double g, double eta)
    : resins_(static_cast<Eigen::Index>(chart.roles.size())),
      channels_(channels),
      observer_(resins_, resins_, channels, {.g = g, .eta = eta}),
      laminates_(chart.laminates, g, eta) {}

void LayerModel::prepare(const Eigen::VectorXd& unknowns, bool with_derivatives) {
    parts_ = parts(unknowns);
    const auto channels = static_cast<std::size_t>(channels_), resins = static_cast<std::size_t>(resins_);
    const auto medium = [&](Eigen::Index r, Eigen::Index c) { return optics::Medium{parts_.a(r, c), parts_.s(r, c)}; };
    std::vector<LaminateReflectance::Laws> laws(channels);
    std::vector<std::vector<double>> seen(channels);
    parallel_for(0, channels, 1, [&](std::size_t c) {
        std::vector<optics::Medium> media;
        for (Eigen::Index r = 0; r < resins_; ++r) media.push_back(medium(r, static_cast<Eigen::Index>(c)));
        laws[c] = laminates_.laws(std::move(media));
        seen[c] = laminates_.rho(laws[c]);
    });
    const auto laminates = static_cast<Eigen::Index>(seen[0].size());
    rho_.resize(laminates, channels_);
    for (std::size_t c = 0; c < channels; ++c)
        rho_.col(static_cast<Eigen::Index>(c)) = Eigen::Map<const Eigen::VectorXd>(seen[c].data(), laminates);
    if (!with_derivatives) return;
    by_a_.assign(channels, Eigen::MatrixXd(laminates, resins_));
    by_s_ = by_a_;
    parallel_for(0, channels * resins * 2, 1, [&](std::size_t task) {
        const std::size_t c = task / (2 * resins), resin = task / 2 % resins;
        const auto r = static_cast<Eigen::Index>(resin);
        const bool scattering = task % 2 == 1;
        optics::Medium moved = medium(r, static_cast<Eigen::Index>(c));
        (scattering ? moved.sigma_s : moved.sigma_a) *= std::exp(log_step);
        const std::vector<double> there = laminates_.rho(laws[c], resin, moved);
        (scattering ? by_s_ : by_a_)[c].col(r) =
            (Eigen::Map<const Eigen::VectorXd>(there.data(), laminates) - rho_.col(static_cast<Eigen::Index>(c))) /
            log_step;
    });
}

Eigen::Vector3d LayerModel::colour(Eigen::Index row, Eigen::Ref<Eigen::Matrix3Xd> by_unknown) const {
    const Eigen::VectorXd seen = parts_.gain * (parts_.surface + rho_.row(row).transpose().array());
    const Eigen::Vector3d colour = parts_.weights.transpose() * seen;
    if (by_a_.empty()) return colour;
    Eigen::Index at = 0;
    for (const auto* by : {&by_a_, &by_s_})
        for (Eigen::Index r = 0; r < resins_; ++r)
            for (Eigen::Index c = 0; c < channels_; ++c)
                by_unknown.col(at++) =
                    parts_.gain * (*by)[static_cast<std::size_t>(c)](row, r) * parts_.weights.row(c).transpose();
    add_observer_derivatives(parts_, seen, by_unknown.rightCols(by_unknown.cols() - at));
    return colour;
}

Eigen::MatrixX3d LayerModel::roots(const ObserverParts& parts) {
    prepare(unknowns_of(parts), false);
    Eigen::MatrixX3d roots = (parts_.gain * (parts_.surface + rho_.array())).matrix() * parts_.weights;
    for (Eigen::Index i = 0; i < roots.rows(); ++i) roots.row(i) = roots_of(roots.row(i).transpose()).transpose();
    return roots;
}

}  // namespace voxtone::calibration

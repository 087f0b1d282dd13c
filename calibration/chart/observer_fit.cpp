// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/observer_fit.h"

#include <algorithm>
#include <array>

#include "base/parallel.h"
#include "calibration/chart/square_colours.h"

namespace voxtone::calibration {

namespace {

// Solids, white above all, are what a print shows most of and what its other colours are seen beside: each counts for
// four. Of 1,136 mixtures of a J750 in four channels white came from 2.5 CIEDE2000 to 1.3 by it, the mean of all from
// 1.215 to 1.23.
constexpr double solid_from = 0.995, solid_weight = 4;

// The sum of squares of laminates has many minima. Of starts that scatter and absorb 0.1 to 3 times as much as 10 per
// mm, those of 3 and of 1 ended lowest on halves of three sets of measured laminates, each failing on a half or two.
constexpr double clearer = 3;

// Mixtures, then squares.
ColourTargets targets_of(const ChartData& data) {
    const Eigen::Index mixtures = data.mixtures(), squares = data.squares.roots.rows();
    ColourTargets targets{Eigen::MatrixX3d(mixtures + squares, 3), data.metric,
                          Eigen::VectorXd::Ones(mixtures + squares)};
    targets.roots << data.roots, data.squares.roots;
    targets.metric.insert(targets.metric.end(), data.squares.metric.begin(), data.squares.metric.end());
    targets.counts.head(mixtures) = data.repeats;
    for (Eigen::Index i = 0; i < mixtures; ++i)
        if (data.shares.row(i).maxCoeff() > solid_from) targets.counts[i] *= solid_weight;
    return targets;
}

class ChartColours : public ColourModel {
public:
    ChartColours(const ChartData& data, const ObserverModel& model, const ObserverParts& known)
        : data_(data), model_(model), known_(known), squares_(data.squares, data.roles, model) {}
    [[nodiscard]] Eigen::Index unknowns() const override { return model_.unknowns(); }
    void prepare(const Eigen::VectorXd& unknowns, bool with_derivatives) override {
        parts_ = model_.parts(unknowns, known_);
        law_ = model_.law(parts_);
        squares_.prepare(parts_, with_derivatives);
    }
    [[nodiscard]] Eigen::Vector3d colour(Eigen::Index row, Eigen::Ref<Eigen::Matrix3Xd> by_unknown) const override {
        if (row >= data_.mixtures()) return squares_.colour(row - data_.mixtures(), by_unknown);
        return model_.colour(parts_, law_, data_.shares.row(row), by_unknown);
    }
    [[nodiscard]] Eigen::Index others() const override { return 2 * static_cast<Eigen::Index>(data_.edges.size()); }
    [[nodiscard]] Eigen::VectorXd other_residuals(const Eigen::VectorXd& unknowns) const override {
        return edge_residuals(data_.edges, model_, model_.parts(unknowns, known_), data_.illuminant);
    }

private:
    const ChartData& data_;
    const ObserverModel& model_;
    const ObserverParts& known_;
    ObserverParts parts_;
    optics::EffectiveMedium law_;
    SquareColours squares_;
};

ObserverFit fit_from(const ChartData& data, const ObserverModel& model, const ObserverParts& start,
                     const ObserverParts& from, const Progress* progress, int most_steps) {
    Eigen::VectorXd unknowns = model.unknowns_of(from);
    ChartColours colours(data, model, start);
    ObserverFit fit;
    fit.converged = fit_colours(targets_of(data), colours, model.unknowns_of(start), unknowns, progress, most_steps);
    fit.parts = model.parts(unknowns, start);
    fit.roots = predicted_roots(model, fit.parts, data.shares);
    fit.square_roots = SquareColours(data.squares, data.roles, model).roots(fit.parts);
    return fit;
}

}  // namespace

Eigen::MatrixX3d predicted_roots(const ObserverModel& model, const ObserverParts& parts,
                                 const Eigen::MatrixXd& shares) {
    Eigen::MatrixX3d roots = model.colours(parts, shares);
    for (Eigen::Index i = 0; i < roots.rows(); ++i) roots.row(i) = roots_of(roots.row(i).transpose()).transpose();
    return roots;
}

ObserverFit fit_observer(const ChartData& data, const ObserverModel& model, const ObserverParts& start,
                         const Progress* progress, int most_steps, const ObserverParts* from) {
    if (from || !data.is_of_laminates())
        return fit_from(data, model, start, from ? *from : start, progress, most_steps);
    std::array<ObserverFit, 2> fits;
    parallel_for(0, fits.size(), 1, [&](std::size_t k) {
        ObserverParts at = start;
        if (k > 0) at.a /= clearer, at.s /= clearer;
        fits[k] = fit_from(data, model, start, at, progress, std::min(most_steps, steps_of_trial));
    });
    const auto misfit = [&](const ObserverFit& fit) {
        return optics::summarize(root_differences(fit.square_roots, data.squares.roots)).mean;
    };
    ObserverFit& better = misfit(fits[1]) < misfit(fits[0]) ? fits[1] : fits[0];
    if (better.converged || most_steps <= steps_of_trial) return better;
    return fit_from(data, model, start, better.parts, progress, most_steps - steps_of_trial);
}

}  // namespace voxtone::calibration

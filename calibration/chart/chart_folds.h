// SPDX-License-Identifier: GPL-3.0-or-later
//
// Fits of parts of a chart, judged by what took no part: mixtures, repeats of one together, thin squares and what edges
// know are cut into folds, and each is predicted by a fit of the others. What that says of choices of channels.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "calibration/chart/chart_data.h"
#include "calibration/chart/chart_options.h"
#include "calibration/chart/observer_model.h"
#include "calibration/chart/residual_fit.h"

namespace voxtone::calibration {

inline constexpr int least_channels = 3, most_channels = 12;

/// The model of a choice, and where its fit starts. What the start knows of the observer holds where the model does not
/// fit it.
[[nodiscard]] ObserverModel chart_model(const ChartData& data, const ObserverChoice& choice,
                                        const ChartFitOptions& options);
[[nodiscard]] ObserverParts chart_start(const ChartData& data, const ObserverChoice& choice,
                                        const ChartFitOptions& options);

/// sigma_s of white in the channels of parts, mm^-1, by the set that gives lengths.
[[nodiscard]] Eigen::VectorXd chart_scattering(const ChartData& data, const ObserverParts& parts,
                                               const ChartFitOptions& options);

/// Fold of each of `count` rows: an even cut of a shuffled order.
[[nodiscard]] std::vector<int> folds_of(Eigen::Index count, int folds, std::uint64_t cut = 0);

struct LeftOut {
    Eigen::MatrixX3d physics, corrected;  ///< roots of every mixture by a fit without its fold
    Eigen::MatrixX3d squares;             ///< the same of every thin square
    std::vector<ObserverParts> parts;     ///< of each fold's fit
};

/// Of so few mixtures or laminates each fold is fitted from the usual start, and chooses its own shape of the residual.
/// Of more that takes long: their fits begin where that of all ended, which a fold moves little, near the same start.
[[nodiscard]] bool is_fitted_anew(const ChartData& data);

/// Every fold by the others. `shape`: of the residual; nullptr: chosen anew by the others. `whole`: the fit of all.
/// Throws Cancelled.
[[nodiscard]] LeftOut leave_out(const ChartData& data, int folds, const ObserverChoice& choice,
                                const ChartFitOptions& options, const ResidualShape* shape, const ObserverParts& whole,
                                const Progress* progress);

struct ChannelCurve {
    std::vector<ChannelChoice> choices;
    double anew = 0;  ///< mean CIEDE2000 where mixtures are judged by the choice that the others make
};
/// Choices that so many mixtures can bear, cross-validated; fewer channels first. Empty: there is one alone.
[[nodiscard]] ChannelCurve channel_curve(const ChartData& data, const ChartFitOptions& options,
                                         const Progress* progress);
/// Sum over folds of the errors by the choice that the other folds make, from errors [choice][fold].
[[nodiscard]] double judged_anew(const std::vector<std::vector<double>>& errors);
/// The fewest channels that are as good as the best. `curve` may be empty.
[[nodiscard]] ObserverChoice best_choice(const std::vector<ChannelChoice>& curve, const ChartFitOptions& options);

/// Mean CIEDE2000 of all mixtures.
[[nodiscard]] double mean_difference(const Eigen::MatrixX3d& predicted, const ChartData& data);

}  // namespace voxtone::calibration

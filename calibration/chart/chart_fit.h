// SPDX-License-Identifier: GPL-3.0-or-later
//
// Resins with channels of their own from a chart of measured mixtures: how many channels, by cross-validation; their
// weights to XYZ and the resins (observer_fit.h); what physics leaves, as a residual (residual_fit.h); lengths, which
// thick mixtures do not tell, from the white of another set.
//
// Errors that are reported are of mixtures that took no part: the mixtures are cut into folds, repeats of one mixture
// together, and each fold is predicted by a fit of the others. Lengths and noise of the residual are chosen anew by the
// others, of many mixtures on all (they are as many numbers as resins, and one). Channels are chosen on all, which
// flatters: `chosen_anew` says by how much. Thin squares, where there are some, are cut into the same folds.
//
// Laminates are fitted by the same unknowns, but with scattering of every resin in mm^-1, since thickness is known;
// their channels are not searched, and there is no residual.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "calibration/chart/chart_options.h"
#include "optics/colour/colour.h"
#include "optics/media/resins.h"

namespace voxtone::calibration {

struct HeldOutPatch {
    std::string mixture;
    double difference = 0;  ///< CIEDE2000
};

/// The largest of differences, first.
[[nodiscard]] std::vector<HeldOutPatch> largest_differences(const std::vector<double>& differences,
                                                            const std::function<std::string(std::size_t)>& name);

struct ChartFit {
    optics::ResinSet set;
    bool of_laminates = false;  ///< figures are of laminates, and what is said of mixtures alone is empty
    optics::DifferenceSummary fitted, held_out, held_out_physics, noise;  ///< CIEDE2000; noise: of repeats
    std::vector<ChannelChoice> curve;                                     ///< of the channels that were tried
    double chosen_anew = 0;      ///< mean CIEDE2000 of the curve where others choose the channels; 0: no choice
    bool residual_anew = false;  ///< held-out figures know nothing of their mixtures from the residual's shape either
    ObserverChoice observer;     ///< what was taken
    std::vector<HeldOutPatch> worst;             ///< largest held-out differences, first
    std::vector<HeldOutPatch> solids;            ///< held-out difference of each resin's solid, where it was measured
    optics::DifferenceSummary squares_held_out;  ///< CIEDE2000 of thin squares left out; count 0: there are none
    std::vector<double> length_error;            ///< relative standard error of white's scattering, by jackknife
    double dot_spread_error = 0;        ///< standard error, by jackknife over the folds; 0: the chart does not tell it
    std::string dot_spread_text;        ///< what the chart says of it, a sentence
    double residual_size = 0;           ///< mean CIEDE2000 between predictions with and without it
    std::vector<std::string> warnings;  ///< where the set must not be trusted
    double seconds = 0;
};

/// From five on, more channels gain little on the laminates of docs/decisions/013; more folds take long.
inline constexpr int usual_laminate_channels = 5, most_laminate_folds = 3;

/// Throws InputError (fewer patches than unknowns can bear, one hue, resins that no patch tells), Cancelled.
[[nodiscard]] ChartFit fit_chart(const PatchTable& table, const ChartFitOptions& options,
                                 const Progress* progress = nullptr);

}  // namespace voxtone::calibration

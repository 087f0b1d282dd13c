// SPDX-License-Identifier: GPL-3.0-or-later
//
// Resins with channels of their own from a chart of measured mixtures: how many channels, by cross-validation; their
// weights to XYZ and the resins (observer_fit.h); what physics leaves, as a residual (residual_fit.h); lengths, which
// thick mixtures do not tell, from the white of another set.
//
// Errors that are reported are of mixtures that took no part: the mixtures are cut into folds, repeats of one mixture
// together, and each fold is predicted by a fit of the others. Lengths and noise of the residual are chosen on all
// (they are as many numbers as resins, and one). Thin squares, where there are some, are cut into the same folds.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "voxtone/base/progress.h"
#include "voxtone/calibration/chart/chart_data.h"
#include "voxtone/calibration/chart/observer_model.h"
#include "voxtone/calibration/patches/patch_table.h"
#include "voxtone/optics/media/resins.h"

namespace voxtone::calibration {

struct ChartFitOptions {
    std::string name;
    int channels = 0;      ///< 3 to 12; 0: as many as cross-validation finds best
    bool residual = true;  ///< keep what physics leaves
    optics::MeasuringGeometry geometry = optics::MeasuringGeometry::directional_45_0;
    double g = 0.4, eta = 1.5;
    std::array<double, 3> pitch_mm{};   ///< of the voxels: their dot spread is fitted; 0: Eq. 7
    int folds = 10;                     ///< of the last cross-validation, >= 2
    optics::ResinSet lengths_from;      ///< whose white's scattering gives mm, or starts what squares tell of it
    PatchTable squares;                 ///< thin squares of the same resins, read by another instrument; empty: none
    std::vector<std::string> expected;  ///< roles that must be there; empty: those of the table
};

/// Cross-validation of one number of channels: mean CIEDE2000 of mixtures left out.
struct ChannelChoice {
    int channels = 0;
    double physics = 0, with_residual = 0;
};

struct HeldOutPatch {
    std::string mixture;
    double difference = 0;  ///< CIEDE2000
};

struct ChartFit {
    optics::ResinSet set;
    optics::DifferenceSummary fitted, held_out, held_out_physics, noise;  ///< CIEDE2000; noise: of repeats
    std::vector<ChannelChoice> curve;            ///< of the numbers of channels that were tried
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

/// Throws InputError (fewer patches than unknowns can bear, one hue, resins that no patch tells), Cancelled.
[[nodiscard]] ChartFit fit_chart(const PatchTable& table, const ChartFitOptions& options,
                                 const Progress* progress = nullptr);

}  // namespace voxtone::calibration

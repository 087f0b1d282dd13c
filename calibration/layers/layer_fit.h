// SPDX-License-Identifier: GPL-3.0-or-later
//
// Resins with channels of their own from measured laminates: the same unknowns as a chart of mixtures
// (calibration/chart/observer_model.h), but with scattering of every resin in mm^-1, since thickness is known, and
// layers over layers in the place of mixtures (laminate_reflectance.h). Least squares by colour_fit.h; derivatives by
// absorption and scattering are differences.
#pragma once

#include <string>
#include <vector>

#include "base/progress.h"
#include "calibration/chart/chart_fit.h"
#include "calibration/layers/layer_chart.h"
#include "optics/media/resins.h"

namespace voxtone::calibration {

struct LayerFitOptions {
    std::string name;
    int channels = 0;  ///< 3 to 12; 0: usual_layer_channels
    int folds = 3;     ///< of the cross-validation; 0: none
    double g = 0.4, eta = 1.5;
};

/// From five on, more channels gain little on the laminates of docs/decisions/013.
inline constexpr int usual_layer_channels = 5;

struct LayerFit {
    optics::ResinSet set;
    optics::DifferenceSummary fitted, held_out;  ///< CIEDE2000; held_out: of laminates left out, count 0 without folds
    std::vector<HeldOutPatch> worst;             ///< largest differences, held out where there are folds, first
    std::vector<std::string> warnings;
    double seconds = 0;
};

/// Throws InputError (fewer laminates than unknowns can bear), Cancelled.
[[nodiscard]] LayerFit fit_layers(const LayerChart& chart, const LayerFitOptions& options,
                                  const Progress* progress = nullptr);

struct LayerCheck {
    std::vector<double> differences;  ///< CIEDE2000 of each laminate
    optics::DifferenceSummary summary;
    std::vector<HeldOutPatch> worst;
};

/// What a set says of laminates, read as it was measured. Throws InputError where it lacks a resin.
[[nodiscard]] LayerCheck check_layers(const optics::ResinSet& set, const LayerChart& chart);

}  // namespace voxtone::calibration

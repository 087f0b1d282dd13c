// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a fit starts whose chart was measured as spectra: bands of those spectra give the observer (observer_bands.h),
// and what is measured in each band tells the resins there, band by band, without any colour. Least squares of cube
// roots of reflectance, three bands at a time as if they were X, Y and Z (colour_fit.h).
#pragma once

#include "base/progress.h"
#include "calibration/chart/chart_data.h"
#include "calibration/chart/observer_model.h"

namespace voxtone::calibration {

/// Of the options, g, eta and geometry count: mixtures are taken as ideal. Contract: the chart has spectra, of no fewer
/// wavelengths than channels; channels >= 3. Throws Cancelled.
[[nodiscard]] ObserverParts spectral_start(const ChartData& data, Eigen::Index channels,
                                           const ObserverModelOptions& options, const Progress* progress = nullptr);

}  // namespace voxtone::calibration

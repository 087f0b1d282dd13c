// SPDX-License-Identifier: GPL-3.0-or-later
//
// What edges do not tell, from the patches of a chart: Elek et al. 2017, supplement, Sec. 6. Cyan in red, magenta in
// green and yellow in blue let nothing of an edge through; mixed with lighter resins they show.
//
// The paper prints all equal mixtures (calibration/target/target_layout.h, layout E; any other target will do) and
// searches the missing values by brute force. Here the edges' values are a prior with their errors
// (calibration/resins/resin_prior.h), the missing ones are searched by brute force, one resin after the other, and then
// all of them go through one least squares with the halftone's medium (calibration/fit/channel_fit.h). What edges tell
// stays as they tell it; extinction and albedo of a channel with a doubt are replaced by those of the common fit, with
// its errors: there the albedo leans on the edges, the extinction on the chart.
#pragma once

#include "calibration/edge/edge_fit.h"
#include "calibration/patches/patch_model.h"
#include "calibration/patches/patch_table.h"

namespace voxtone::calibration {

/// What edges tell, for a fit of patches.
[[nodiscard]] ResinPrior edge_prior(const EdgeFit& fit);

/// `model`: its g and eta are replaced by those of the fit. A resin that the chart lacks stays as it is. Throws
/// InputError where the patches are none that a fit could use.
void complete_by_chart(EdgeFit& fit, const PatchTable& chart, PatchModelOptions model);

}  // namespace voxtone::calibration

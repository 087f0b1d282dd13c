// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a tray will take: its parts are read, arranged and estimated as each would be alone (print/estimate_job.h),
// and added up, copies counted for what they take: resin, disk and a share of the layers' time, but no loop.
#pragma once

#include "base/progress.h"
#include "slicer/plans/tray_plan.h"
#include "slicer/print/estimate_job.h"

namespace voxtone::slicer {

/// Nothing is written. Of several trays the size is that of the first, and the layers are those of all. `models` are
/// the parts; with none the options name the plan. Throws as the tray would with --fail-fast.
[[nodiscard]] JobEstimate estimate_tray(const SliceOptions& asked, const TrayModels& models, Progress& progress,
                                        const EstimateScope& scope);

}  // namespace voxtone::slicer

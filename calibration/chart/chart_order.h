// SPDX-License-Identifier: GPL-3.0-or-later
//
// A printed chart that was measured in another order than its table says: turned, mirrored, or by columns. Its mixtures
// are shuffled, so that colours of the wrong patches fit nothing: each order is fitted in three channels without a
// residual, and the one that fits is the one that was measured.
#pragma once

#include <string>

#include "calibration/chart/chart_fit.h"
#include "calibration/patches/patch_table.h"

namespace voxtone::calibration {

/// Throws InputError that names the order in which the chart was measured, where it is not the table's. Looks at
/// nothing where a patch has no place, or where the table's own order fits.
void expect_order(const PatchTable& table, const ChartFitOptions& options);

}  // namespace voxtone::calibration

// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is told of a tray whose shards were laid together: they are the bits of the tray in one go.
#pragma once

#include "base/progress.h"
#include "slicer/print/merge_job.h"

namespace voxtone::slicer {

/// For run_merge_job. With `predict` the parts are predicted, for which their layers are made once more, in memory, and
/// the page is drawn; without, tray.json and the figures are written alone.
[[nodiscard]] MergedTelling telling_of_tray(const MergeOptions& options, Progress& progress);

}  // namespace voxtone::slicer

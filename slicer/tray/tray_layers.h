// SPDX-License-Identifier: GPL-3.0-or-later
//
// The layers of a tray.
#pragma once

#include "base/progress.h"
#include "slicer/job/job_phases.h"
#include "slicer/layers/composed_layers.h"
#include "slicer/prepare/opened_job.h"

namespace voxtone::slicer {

/// All layers of a print of this grid.
void watch_all(LayerWatchers& watchers, const VoxelGrid& grid, const OpenedJob& job);

/// Makes the layers of the range, in slabs side by side; each goes to `take` and to those who look on.
void make_tray_layers(const ComposedLayers& layers, const LayerRange& range, const LayerTaker& take,
                      LayerWatchers& watchers, Progress& progress);

}  // namespace voxtone::slicer

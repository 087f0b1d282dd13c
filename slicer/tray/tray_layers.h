// SPDX-License-Identifier: GPL-3.0-or-later
//
// The layers of a tray, and those of its parts for their own reports.
#pragma once

#include "base/progress.h"
#include "slicer/job/job_phases.h"
#include "slicer/layers/composed_layers.h"
#include "slicer/tray/opened_tray.h"
#include "slicer/tray/tray_report.h"

namespace voxtone::slicer {

/// All layers of a print of this grid.
void watch_all(LayerWatchers& watchers, const VoxelGrid& grid, const OpenedJob& job);

/// Makes the layers of the range, in slabs side by side; each goes to `take` and to those who look on.
void make_tray_layers(const ComposedLayers& layers, const LayerRange& range, const LayerTaker& take,
                      LayerWatchers& watchers, Progress& progress);

/// An empty report, which shares its room out among all copies.
[[nodiscard]] TrayReport report_for(const PreparedTray& prepared, const std::filesystem::path& out);

/// Predicts each part alone and writes its report: its layers are made for that, and not written.
void report_parts(PreparedTray& prepared, TrayReport& tray, Progress& progress);

}  // namespace voxtone::slicer

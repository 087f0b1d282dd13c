// SPDX-License-Identifier: GPL-3.0-or-later
//
// Phases of a job that bodies and trays, whole, in shards and merged, have in common, in the order in which they go
// through them.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/progress.h"
#include "base/stopwatch.h"
#include "io/layers/gcvf_writer.h"
#include "io/layers/layer_runs.h"
#include "io/report/report.h"
#include "slicer/layers/layer_source.h"
#include "slicer/look/thumbnails.h"
#include "slicer/look/voxel_sample.h"
#include "slicer/part/job_body.h"
#include "slicer/part/opened_job.h"
#include "slicer/part/print.h"
#include "slicer/plate/slice_report.h"

namespace voxtone::slicer {

/// The printed body for a container's preview.
class BodyPreview {
public:
    /// Of a body that lasts as long. `wanted`: whether there is a container; else it is empty.
    BodyPreview(const JobBody& body, bool wanted);
    [[nodiscard]] io::PreviewMesh mesh() const;

private:
    std::vector<std::array<float, 3>> positions_mm_;
    std::span<const std::array<std::uint32_t, 3>> triangles_;
};

/// Where a finished layer goes; from any thread.
using LayerTaker = std::function<void(int k, const io::LayerRuns& layer)>;

/// What the report keeps of layers while they are made.
struct LayerWatchers {
    std::optional<Thumbnails> thumbnails;
    std::optional<VoxelSample> voxels;
    /// Both, of these layers of a print.
    void watch(const LayerRange& layers, const VoxelGrid& grid, const OpenedJob& job);
    /// From any thread, once for each layer.
    void take_layer(int k, const io::LayerRuns& layer);
};

/// Makes the layers of the range, in slabs side by side, as many as memory allows; each goes to `take` and to those who
/// look on.
void make_layers(const LayerSource& layers, const LayerRange& range, const LayerTaker& take, LayerWatchers& watchers,
                 JobMeasurements& figures, Progress& progress);
/// Those of a body, whose print looks on, too.
void make_layers(Print& print, const LayerRange& range, const LayerTaker& take, LayerWatchers& watchers,
                 JobMeasurements& figures, Progress& progress);

/// Draws what the page of a report shows. `layer_file`: of the print's layers, as the page finds them; empty: nowhere.
void draw_report(const Print& print, io::Report& report, std::optional<VoxelSample>& voxels, std::string layer_file,
                 Progress& progress);

/// Draws and writes the report, if it was asked for, and its figures: what a job of one body ends with.
[[nodiscard]] JobResult write_report(const OpenedJob& job, const Print& print, io::Report& report,
                                     std::optional<VoxelSample>& voxels, const Stopwatch& since_begin,
                                     Progress& progress);

}  // namespace voxtone::slicer

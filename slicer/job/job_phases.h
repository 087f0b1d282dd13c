// SPDX-License-Identifier: GPL-3.0-or-later
//
// Phases of a job that whole jobs, shards and merges have in common (slice_job.cpp, shards/shard_job.cpp,
// shards/merge_job.cpp), in the order in which they go through them.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "base/progress.h"
#include "base/stopwatch.h"
#include "io/layers/layer_runs.h"
#include "io/report/report.h"
#include "slicer/job/slice_report.h"
#include "slicer/kept/job_identity.h"
#include "slicer/look/thumbnails.h"
#include "slicer/look/voxel_sample.h"
#include "slicer/prepare/job_body.h"
#include "slicer/prepare/opened_job.h"
#include "slicer/prepare/print.h"

namespace voxtone::slicer {

/// Reads the model, and says what there is to say of it. Throws FileError, InputError.
[[nodiscard]] JobBody read_body(const OpenedJob& job, JobMeasurements& figures, Progress& progress);

/// Shards of another job in the output folder. Throws InputError.
void expect_no_other_shards(const OpenedJob& job, const Progress* progress);

/// What an appearance loop came to, where the job would read it, must be of this job: what can be said of that before
/// the model is read. Throws InputError, FileError.
void expect_own_loop(const OpenedJob& job, const Progress* progress);

/// Says what inputs have changed since the job file was written that the job came from.
[[nodiscard]] JobIdentity identify_said(const OpenedJob& job, const JobBody& body, Progress& progress);

/// Loads the resins that suit the model best, where the printer leaves a choice.
void load_best_resins(OpenedJob& job, const JobBody& body, Progress& progress);

/// Says how much disk will be needed and is free. Throws TryAgain where that is too little.
void expect_disk_space(const OpenedJob& job, const JobBody& body, const LayerRange& range, Progress& progress);

/// Keeps references to all three.
[[nodiscard]] std::unique_ptr<Print> make_print(const OpenedJob& job, const JobBody& body, const JobIdentity& identity,
                                                Progress& progress);

/// Where a finished layer goes; from any thread.
using LayerTaker = std::function<void(int k, const io::LayerRuns& layer)>;

/// What the report keeps of layers while they are made.
struct LayerWatchers {
    std::optional<Thumbnails> thumbnails;
    std::optional<VoxelSample> voxels;
    /// From any thread, once for each layer.
    void see(int k, const io::LayerRuns& layer);
};

/// Makes the layers of the range, in slabs side by side; each goes to `take` and to those who look on.
void make_layers(Print& print, const LayerRange& range, const LayerTaker& take, LayerWatchers& watchers,
                 JobMeasurements& figures, Progress& progress);

/// Draws and writes the report, if it was asked for, and its figures; these as JSON.
[[nodiscard]] std::string write_report(const OpenedJob& job, const Print& print, io::Report& report,
                                       std::optional<VoxelSample>& voxels, const Stopwatch& since_begin,
                                       Progress& progress);

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
//
// How long each phase of a job takes and how much memory it holds: by counts of what it works on (cells of the surface,
// voxels of the shell and of the grid), times what one of them took in jobs that were measured.
#pragma once

#include <initializer_list>
#include <vector>

#include "base/job_outlook.h"
#include "slicer/part/loop_plan.h"
#include "slicer/part/opened_job.h"
#include "slicer/part/phase.h"
#include "slicer/part/prediction_plan.h"

namespace voxtone::slicer {

/// What there is to do, decided.
struct PlannedWork {
    const LayerRange& layers;
    const LoopPlan& loop;
    const PredictionPlan& prediction;
};

/// From the moment at which the body is known and `resident_bytes` are held; `threads` work at once.
[[nodiscard]] std::vector<PhaseEstimate> phase_estimates(const OpenedJob& job, const JobBody& body,
                                                         const PlannedWork& work, std::size_t threads,
                                                         std::uint64_t resident_bytes);

/// Wall clock of so many seconds of processors, of which one thread does a small part alone.
[[nodiscard]] double seconds_on_threads(double cpu_s, std::size_t threads);

/// The phases for the time that is shown as left.
[[nodiscard]] std::vector<ExpectedStage> expected_stages(const std::vector<PhaseEstimate>& phases);
/// Of a part of a job, which goes through these alone.
[[nodiscard]] std::vector<ExpectedStage> expected_stages(const std::vector<PhaseEstimate>& phases,
                                                         std::initializer_list<Phase> those);

/// Most that any phase of a job holds beside its body and its textures, for so much coloured surface seen in cells of
/// `cell_mm`, whatever it does there.
[[nodiscard]] double most_bytes_of_surface(double area_mm2, double cell_mm);

/// Most that the print's voxels take while they wait to be predicted.
[[nodiscard]] std::uint64_t bytes_of_voxels(const OpenedJob& job, const JobBody& body, const LayerRange& range);

/// Most that these layers of the stack and its report, or before them the loop, take on disk.
[[nodiscard]] std::uint64_t disk_bytes(const OpenedJob& job, const JobBody& body, const LayerRange& range,
                                       const LoopPlan& loop);
/// Most that one more copy of it on its plate takes, of which nothing is told besides.
[[nodiscard]] std::uint64_t disk_bytes_of_copy(const OpenedJob& job, const JobBody& body, const LayerRange& range);

}  // namespace voxtone::slicer

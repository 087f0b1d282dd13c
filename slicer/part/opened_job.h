// SPDX-License-Identifier: GPL-3.0-or-later
//
// A job before its model is read: options, printer, resins. What is wrong with any of them is said here, before time is
// spent.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "io/layers/layer_stack_writer.h"
#include "slicer/options/resolved_job.h"
#include "slicer/part/job_body.h"
#include "slicer/part/job_colour.h"
#include "slicer/part/other_print.h"
#include "slicer/printer/printer.h"

namespace voxtone::slicer {

/// What one run of a job does beside what its options say: no part of what the job is.
struct JobRun {
    bool goes_on = false;         ///< with the saved state of its loop
    bool loop_elsewhere = false;  ///< its loop is not run by this job: what it came to must be there
    bool loop_done = false;       ///< it was run before, and takes nothing any more
    std::string why_unpredicted;  ///< a sentence: nothing is predicted, whatever was asked for
};

/// Const once it is opened: who wants another opens another.
struct OpenedJob {
    ResolvedJob options;
    PrinterProfile printer;
    LoadedResins resins;
    std::shared_ptr<const OtherPrint> other;  ///< null: the surface shows colours
    std::string why_these_resins;             ///< where they were chosen for the model (resin_choice.h)

    JobRun run;

    /// Loads these instead. What was asked for stays as it was: the same job chooses the same again.
    void load(const std::vector<std::string>& roles);

    /// Background and resins, as the bitmaps colour them.
    [[nodiscard]] std::vector<io::Rgb> palette() const;
    /// What is written: the formats asked for, or the printer's.
    [[nodiscard]] io::StackOutputs outputs() const;
    /// The layers of this range as they will be written.
    [[nodiscard]] io::StackDescription describe(const VoxelGrid& grid, const LayerRange& range) const;
};

/// Changes nothing on disk. Throws UsageError, InputError, FileError.
[[nodiscard]] OpenedJob open_job(const SliceOptions& asked);
/// `decide`: what this run does, of a job that is opened otherwise. Throws what it throws.
using DecideRun = std::function<void(const OpenedJob& job, JobRun& run)>;
[[nodiscard]] OpenedJob open_job(const SliceOptions& asked, const DecideRun& decide);

}  // namespace voxtone::slicer

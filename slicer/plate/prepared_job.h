// SPDX-License-Identifier: GPL-3.0-or-later
//
// A job that stands ready: bodies, whole, in shards and merged (slicer/print), and the parts of trays open theirs here
// and nowhere else.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "base/progress.h"
#include "slicer/part/job_body.h"
#include "slicer/part/job_identity.h"
#include "slicer/part/job_plan.h"
#include "slicer/part/opened_job.h"
#include "slicer/part/print.h"
#include "slicer/plate/slice_report.h"

namespace voxtone::slicer {

/// Stays where it was made: the print refers to the rest.
class PreparedJob {
public:
    /// Reads the model, unless an earlier job of it kept the body, says what there is to say of it and of inputs that
    /// have changed since the job file was written, loads the resins that suit it best, plans, and makes the print: its
    /// colours are separated, or its stacks searched. What the options refuse then refuses Print::prepare. Throws
    /// FileError, InputError, UsageError, Cancelled.
    PreparedJob(OpenedJob opened, std::optional<JobBody> kept, Progress& progress);
    PreparedJob(const PreparedJob&) = delete;
    PreparedJob& operator=(const PreparedJob&) = delete;

    JobMeasurements figures;
    const JobBody body;
    const JobIdentity identity;
    const OpenedJob job;
    const JobPlan plan;
    const std::unique_ptr<Print> print;
};

/// What an appearance loop came to, where the job would read it, must be of this job: what can be said of that before
/// the model is read. Throws InputError, FileError.
void expect_own_loop(const OpenedJob& job, const Progress* progress);

/// Says how much disk will be needed and is free. Throws TryAgain where that is too little.
void expect_disk_space(const std::filesystem::path& out, std::uint64_t needed_bytes, Progress& progress);

}  // namespace voxtone::slicer

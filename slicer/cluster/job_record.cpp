// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/cluster/job_record.h"

#include <chrono>
#include <thread>

#include <fmt/core.h>

#include "base/error.h"
#include "io/programs/build_identity.h"
#include "slicer/batch/batch_summary.h"
#include "slicer/batch/job_result.h"
#include "slicer/options/command_words.h"
#include "slicer/options/job_file.h"

namespace voxtone::slicer {

PlannedJob handed_over_job(const BatchFolder& batch, const std::string& name) {
    PlannedJob job;
    job.name = name;
    read_job(SubmissionFolder(batch).job_file(name).string(), job.options);
    job.out = batch.job_folder(name);
    job.options.out = job.out.string();
    job.command = command_words(job.options);
    return job;
}

std::unique_ptr<io::FolderLock> wait_for_job(const BatchFolder& batch, const std::string& name) {
    constexpr int tries = 600;
    constexpr std::chrono::milliseconds between(50);
    for (int i = 0; i < tries; ++i) {
        if (auto lock = batch.lock(name)) return lock;
        std::this_thread::sleep_for(between);
    }
    return nullptr;
}

void change_state(const BatchFolder& batch, const std::string& name, Progress& progress,
                  const std::function<void(JobState&)>& change) {
    try {
        const auto lock = wait_for_job(batch, name);
        if (!lock) {
            progress.warn(fmt::format("{}: its state is not noted, as a batch on another machine works on it", name));
            return;
        }
        if (!lock->doubt().empty()) progress.warn(lock->doubt());
        JobState state = batch.state_of(name).value_or(JobState());
        state.name = name;
        change(state);
        batch.publish(state);
    } catch (const Error& error) {
        progress.warn(fmt::format("{}: its state could not be noted: {}", name, error.what()));
    }
}

void note_stack(JobState& state, const BatchFolder& batch, const PlannedJob& job, const Submission& submission,
                InputDigests& digests, Progress& progress) {
    const std::string no_picture =
        take_stack(job.out, submission.began_ns, batch.picture_file(job.name), digests, state);
    if (!no_picture.empty()) progress.warn(fmt::format("{}: {}", job.name, no_picture));
    state.phase = JobPhase::done;
    state.program = io::build_identity();
    state.command = job.command;
    state.runner.reset();
    state.exit_code = 0;
    state.message.clear();
    state.finished = utc_now();
}

void summarise_batch(const BatchFolder& batch, Progress& progress) {
    try {
        write_batch_summary(batch);
    } catch (const Error& error) {
        progress.warn(fmt::format("the summary could not be written: {}", error.what()));
    }
}

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/cluster/job_record.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <system_error>
#include <thread>

#include <fmt/core.h>

#include "base/error.h"
#include "base/warning.h"
#include "farm/batch/batch_summary.h"
#include "farm/batch/job_life.h"
#include "farm/batch/job_result.h"
#include "slicer/options/command_words.h"
#include "slicer/options/job_file.h"

namespace voxtone::farm {

namespace fs = std::filesystem;

PlannedJob handed_over_job(const BatchFolder& batch, const std::string& name) {
    PlannedJob job;
    job.name = name;
    slicer::read_job(SubmissionFolder(batch).job_file(name).string(), job.options);
    job.out = batch.job_folder(name);
    job.options.out = job.out.string();
    job.command = slicer::command_words(job.options);
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
            progress.warn(named_warning(
                "not-noted",
                fmt::format("{}: its state is not noted, as a batch on another machine works on it", name)));
            return;
        }
        if (!lock->doubt().empty()) progress.warn(named_warning("lock-doubt", lock->doubt()));
        JobState state = batch.state_of(name).value_or(JobState());
        state.name = name;
        change(state);
        batch.publish(state);
    } catch (const Error& error) {
        progress.warn(
            named_warning("not-noted", fmt::format("{}: its state could not be noted: {}", name, error.what())));
    }
}

void note_stack(JobState& state, const BatchFolder& batch, const PlannedJob& job, const Submission& submission,
                Progress& progress) {
    const std::string no_picture = take_stack(job.out, submission.began_ns, batch.picture_file(job.name), state);
    if (!no_picture.empty()) progress.warn(named_warning("not-noted", fmt::format("{}: {}", job.name, no_picture)));
    note_done(state);
    state.command = job.command;
}

void summarise_batch(const BatchFolder& batch, Progress& progress) {
    try {
        write_batch_summary(batch);
    } catch (const Error& error) {
        progress.warn(named_warning("not-noted", fmt::format("the summary could not be written: {}", error.what())));
    }
}

void summarise_at_times(const BatchFolder& batch, const std::string& name, std::size_t jobs, Progress& progress) {
    constexpr double least_s = 60, each_s = 0.1;
    std::error_code none;
    // Both times are those of the file system, whose clock may not be ours.
    const auto page = fs::last_write_time(batch.path() / batch_page_name, none);
    const auto state = none ? page : fs::last_write_time(batch.state_file(name), none);
    const std::chrono::duration<double> age = state - page;
    if (!none && age.count() < std::max(least_s, each_s * double(jobs))) return;
    try {
        const auto lock = batch.lock_summary();
        if (lock) summarise_batch(batch, progress);
    } catch (const Error& error) {
        progress.warn(named_warning("not-noted", fmt::format("the summary could not be written: {}", error.what())));
    }
}

}  // namespace voxtone::farm

// SPDX-License-Identifier: GPL-3.0-or-later
//
// One job of a batch on its way from the plan to a whole result: its process, its lock, its state on disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "base/progress.h"
#include "base/stopwatch.h"
#include "farm/batch/batch_folder.h"
#include "farm/batch/batch_view.h"
#include "farm/batch/job_life.h"
#include "farm/batch/job_process.h"
#include "farm/batch/job_weight.h"
#include "farm/batch/plan.h"

namespace voxtone::farm {

struct BatchOptions {
    std::filesystem::path out;
    std::filesystem::path program;   ///< `voxtone`
    int jobs = 0;                    ///< most at once; 0: as many as cores and memory allow
    int cores = 0;                   ///< that all share; 0: every one there is
    std::uint64_t memory_bytes = 0;  ///< that all share; 0: the machine's
    int retries = 5;                 ///< of a job that failed for no fault of its own
    double estimate_from_s = 25;     ///< jobs are estimated while they wait where those of this batch take so long
    double backoff_s = 2;            ///< before the first of them; twice as long before each further one
    bool fail_fast = false;
    double wait_s = 60;  ///< in a watched folder: for the files that a model names beside itself
    std::string after;   ///< command for the shell, once a result is whole; empty: none
};

/// As the options say, or the machine's.
[[nodiscard]] std::uint64_t memory_to_share(const BatchOptions& options);

/// What the jobs of a batch share.
struct BatchContext {
    const BatchOptions& options;
    const BatchFolder& folder;
    BatchView& view;
    const Progress& progress;
};

class QueuedJob {
public:
    enum class Stage { waiting, weighing, running, following, done, failed };

    /// Looks what is there of it: a job that was done and has not changed is done.
    QueuedJob(BatchContext& context, PlannedJob job, std::size_t number);

    [[nodiscard]] const std::string& name() const { return job_.name; }
    [[nodiscard]] Stage stage() const { return stage_; }
    [[nodiscard]] bool was_unchanged() const { return unchanged_; }
    [[nodiscard]] const JobState& state() const { return state_; }
    [[nodiscard]] const JobWeight& weight() const { return weight_; }
    [[nodiscard]] int threads() const { return threads_; }  ///< while it runs
    /// Whether it may be started now: it may have to wait after a failure, or for another batch.
    [[nodiscard]] bool is_due() const { return stage_ == Stage::waiting && since_pause_.total() >= pause_s_; }

    /// Begins to ask the estimate what the job takes, where only a bound is known; it waits again after that.
    void begin_to_weigh();
    /// Whether nothing is known yet of the time that it takes.
    [[nodiscard]] bool wants_estimate() const { return stage_ == Stage::waiting && tries_ == 0 && !was_weighed_; }
    void warn_that_it_runs_alone(std::uint64_t memory_there_is) const;
    /// Begins to run, unless another batch holds it or has just done it. Throws Cancelled.
    void start(int threads);
    /// Looks whether what runs has ended, and does what comes then.
    void poll();
    /// Asks what runs to stop, or kills it. What ends then is not tried again.
    void ask_to_stop(int signal);
    [[nodiscard]] BatchSnapshot::Running snapshot() const;

private:
    void claim_folder();
    [[nodiscard]] bool is_unchanged(const std::optional<JobState>& known);
    [[nodiscard]] std::vector<std::string> words_to_start() const;
    void take_lock_and_run(int threads);
    void run(const std::vector<std::string>& arguments);
    void take_end_of_weighing();
    void note_expected_time();
    void take_end_of_job(const ProcessEnd& end);
    [[nodiscard]] Attempts attempts() const;
    void note_whether_it_got_on();
    void tell_losses() const;
    void take_step(const NextStep& step);
    void finish_stack();
    void read_stack();
    void fail(int exit_code, const std::string& message);
    void wait_again(const NextStep& step, JobEvent::Kind event);
    void follow();
    void take_end_of_follower(const ProcessEnd& end);
    void leave(Stage stage);
    void publish();
    void notify(JobEvent::Kind kind, const std::string& message = {}) const;

    BatchContext& context_;
    PlannedJob job_;
    JobState state_;
    JobWeight weight_;
    Stage stage_ = Stage::waiting;
    bool unchanged_ = false, stopping_ = false, noted_elsewhere_ = false, has_got_more_ = false, was_weighed_ = false;
    int threads_ = 0, tries_ = 0;
    double pause_s_ = 0;
    Stopwatch since_pause_, since_start_;
    std::int64_t began_ns_ = 0;
    std::uintmax_t log_begin_ = 0;
    std::uint64_t oom_kills_before_ = 0;
    std::size_t steps_before_ = 0;  ///< of its loop, as it was saved
    std::unique_ptr<io::FolderLock> lock_;
    std::unique_ptr<JobProcess> process_;
};

}  // namespace voxtone::farm

// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/cluster/cluster_task.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>
#include <thread>

#include <fmt/core.h>

#include "base/control_group.h"
#include "base/error.h"
#include "base/machine_memory.h"
#include "base/parallel.h"
#include "base/warning.h"
#include "farm/batch/job_ending.h"
#include "farm/batch/job_life.h"
#include "farm/batch/job_log.h"
#include "farm/batch/job_process.h"
#include "farm/batch/job_result.h"
#include "farm/cluster/folder_words.h"
#include "farm/cluster/job_record.h"
#include "farm/cluster/slurm_commands.h"
#include "farm/cluster/stage_memory.h"
#include "farm/cluster/submission.h"
#include "io/files/file_digest.h"
#include "io/files/json_writer.h"
#include "slicer/options/command_words.h"
#include "slicer/part/loop_checkpoint.h"

namespace voxtone::farm {

namespace {

namespace fs = std::filesystem;
using std::chrono::steady_clock;

const SubmittedStage& stage_in(const Submission& submission, const TaskOptions& options) {
    for (const SubmittedStage& submitted : submission.stages)
        if (submitted.stage == options.stage) return submitted;
    throw InputError(fmt::format("{}: job {} was handed over without a stage {}: it was submitted anew since",
                                 options.out.string(), options.job, name_of(options.stage)));
}

ChainStage chain_stage(const SubmittedStage& submitted) {
    ChainStage stage;
    stage.stage = submitted.stage;
    stage.arguments = submitted.arguments;
    stage.tasks = submitted.tasks;
    return stage;
}

/// That of this very stage: who does a task by hand, or for another scheduler, within an allocation of Slurm's has no
/// say over that.
SlurmAllocation allocation_of(const SubmittedStage& stage) {
    SlurmAllocation own = own_slurm_allocation();
    const bool is_ours = std::find(stage.numbers.begin(), stage.numbers.end(), own.number) != stage.numbers.end();
    return is_ours ? own : SlurmAllocation();
}

/// Passes the messages of Open Job Description on that the work writes to its log.
class LogRelay {
public:
    LogRelay(fs::path log, std::uintmax_t begin, const MessageSink& sink)
        : log_(std::move(log)), at_(begin), sink_(sink) {}

    void pass_on() {
        if (!sink_ || log_size(log_) <= at_) return;
        std::ifstream in(log_, std::ios::binary);
        in.seekg(static_cast<std::streamoff>(at_));
        for (std::string line; std::getline(in, line) && !in.eof();) {  // what is not yet whole comes next time
            at_ += line.size() + 1;
            if (line.starts_with("openjd_")) sink_(line + "\n");
        }
    }

private:
    fs::path log_;
    std::uintmax_t at_;
    const MessageSink& sink_;
};

class ClusterTask {
public:
    ClusterTask(const TaskOptions& options, Progress& progress)
        : options_(options),
          progress_(progress),
          batch_(BatchFolder::open(options.out)),
          files_(batch_),
          job_(handed_over_job(batch_, options.job)),
          submission_(read_submission()),
          stage_(chain_stage(stage_in(submission_, options))),
          allocation_(allocation_of(stage_in(submission_, options))),
          index_(options.shard ? int(options.shard->shard) : 1) {
        if (options.shard && int(options.shard->of) != stage_.tasks)
            throw InputError(fmt::format("{}: job {} has {} shards, and not {}: it was submitted anew since",
                                         options.out.string(), options.job, stage_.tasks, options.shard->of));
    }

    JobResult run() {
        const std::vector<std::string> arguments = arguments_to_start();
        const fs::path log = files_.task_log(job_.name, options_.stage, index_);
        std::vector<std::string> shown{options_.program.string()};
        shown.insert(shown.end(), arguments.begin(), arguments.end());
        append_line(log, fmt::format("== {} {}: {}", utc_now(), io::host_name(), slicer::shell_line(shown)));
        const std::uintmax_t begin = log_size(log);
        const std::uint64_t kills_before = cgroup_oom_kills();
        steps_before_ = slicer::LoopCheckpoint::saved_steps(job_.out);
        JobProcess process(ProcessStart{options_.program, arguments, {}, log, -1});
        note_start(process);
        const ProcessEnd end = wait_for(process, log, begin);
        return take(ending_of(end, last_words(log, begin), progress_.cancelled(), cgroup_oom_kills() - kills_before));
    }

private:
    /// One that is not complete is just being handed over, under the job's lock: this task has begun at once.
    Submission read_submission() const {
        auto submission = files_.read(options_.job);
        if (!submission || !submission->complete) {
            (void)wait_for_job(batch_, options_.job);
            submission = files_.read(options_.job);
        }
        if (submission) return *std::move(submission);
        throw InputError(
            fmt::format("{}: nothing says that job {} was handed over", options_.out.string(), options_.job));
    }

    std::vector<std::string> arguments_to_start() {
        std::vector<std::string> arguments = arguments_of(stage_, index_);
        const auto state = batch_.state_of(job_.name);
        if (state)
            for (const auto& [file, digest] : state->inputs) io::file_digests().learn(file, digest);
        const bool ours = state && state->folder_is_ours;
        for (std::string& word : words_for_folder(options_.stage, job_, ours, progress_))
            arguments.push_back(std::move(word));
        if (options_.threads > 0 && std::find(arguments.begin(), arguments.end(), "--threads") == arguments.end())
            arguments.insert(arguments.end(), {"--threads", std::to_string(options_.threads)});
        if (options_.relay) arguments.insert(arguments.end(), {"--progress", "openjd"});
        return arguments;
    }

    [[nodiscard]] std::string stage_text() const {
        return stage_.stage == TaskStage::layers ? fmt::format("shard {} of {}", index_, stage_.tasks)
                                                 : std::string(name_of(stage_.stage));
    }

    void note_start(const JobProcess& process) {
        runner_ = {io::host_name(), process.pid(), process.start_time(), utc_now()};
        change_state(batch_, job_.name, progress_, [&](JobState& state) {
            // A shard that failed is not forgotten because others run.
            if (state.phase == JobPhase::failed && stage_.stage == TaskStage::layers) return;
            voxtone::farm::note_start(state, runner_, allocation_.restarts + 1,
                                      options_.threads > 0 ? options_.threads : int(thread_count()));
        });
    }

    /// Passes a request to stop on, and gives the work time to save itself.
    ProcessEnd wait_for(JobProcess& process, const fs::path& log, std::uintmax_t begin) {
        LogRelay relay(log, begin, options_.relay);
        constexpr std::chrono::milliseconds ask_every(50);
        constexpr std::chrono::seconds patience(40);
        std::optional<steady_clock::time_point> requested;
        for (;;) {
            const auto end = process.ended();
            relay.pass_on();
            if (end) return *end;
            if (progress_.cancelled() && !requested) {
                requested = steady_clock::now();
                process.send(SIGTERM);
            }
            if (requested && steady_clock::now() - *requested > patience) process.send(SIGKILL);
            std::this_thread::sleep_for(ask_every);
        }
    }

    JobResult take(const JobEnding& ending) {
        const NextStep step =
            next_step(ending, {allocation_.restarts + 1, options_.retries, false, false, tries_that_got_on()});
        switch (step.kind) {
            case NextStep::Kind::finish:
                return take_done();
            case NextStep::Kind::again:
            case NextStep::Kind::with_more:
            case NextStep::Kind::put_aside:
                // What begins anew comes no further in the same time.
                if (!keeps_what_it_did(options_.stage, job_.options) && time_that_is_over()) break;
                return try_again(step);
            case NextStep::Kind::fail:
            case NextStep::Kind::fail_with_stack:
                break;
        }
        return fail(ending, step);
    }

    /// Those before, and this one where its loop has come further.
    [[nodiscard]] int tries_that_got_on() const {
        const auto state = batch_.state_of(job_.name);
        const bool got_on = slicer::LoopCheckpoint::saved_steps(job_.out) > steps_before_;
        return (state ? state->attempts_that_got_on : 0) + (got_on ? 1 : 0);
    }

    JobResult take_done() {
        const bool is_last = stage_.stage == TaskStage::whole || stage_.stage == TaskStage::merge;
        change_state(batch_, job_.name, progress_, [&](JobState& state) {
            if (is_last) {
                note_stack(state, batch_, job_, submission_, progress_);
            } else if (state.phase != JobPhase::failed) {
                leave(state);
                state.message = fmt::format("{}: {} is done", submission_.text(), stage_text());
            }
        });
        if (is_last) summarise_at_times(batch_, job_.name, submission_.jobs, progress_);
        return result(ExitCode::done, "done");
    }

    /// To the queue, where it came from there and nobody takes it out.
    JobResult try_again(const NextStep& step) {
        const int got_on = tries_that_got_on();
        change_state(batch_, job_.name, progress_, [&](JobState& state) {
            if (state.phase == JobPhase::failed) return;
            leave(state);
            state.exit_code = step.exit_code;
            state.message = fmt::format("{}: {}", stage_text(), step.message);
            state.attempts_that_got_on = got_on;
        });
        const std::string& own = allocation_.task;
        if (!own.empty() && !is_taken_out_of_slurm(own) && requeue_in_slurm(own)) {
            // Slurm ends this task now; one that ended by itself before would be counted as failed.
            std::this_thread::sleep_for(std::chrono::duration<double>(options_.requeue_patience_s));
        }
        return result(static_cast<ExitCode>(step.exit_code), step.message);
    }

    JobResult fail(const JobEnding& ending, const NextStep& step) {
        std::string message = step.message;
        if (ending.kind == JobEnding::Kind::starved) message += what_it_was_given();
        if (ending.kind == JobEnding::Kind::again)
            if (const auto time = time_that_is_over()) message += time_it_was_given(*time);
        change_state(batch_, job_.name, progress_, [&](JobState& state) {
            if (ending.kind == JobEnding::Kind::starved) note_starved(files_, job_.name, stage_.stage);
            if (step.kind == NextStep::Kind::fail_with_stack) note_stack(state, batch_, job_, submission_, progress_);
            note_failed(state, step.exit_code,
                        stage_.stage == TaskStage::whole ? message : fmt::format("{}: {}", stage_text(), message));
        });
        summarise_at_times(batch_, job_.name, submission_.jobs, progress_);
        // What was tried often enough no scheduler is to try again.
        const bool given_up = ending.kind == JobEnding::Kind::again;
        return result(given_up ? ExitCode::unfinished : static_cast<ExitCode>(step.exit_code), message);
    }

    [[nodiscard]] std::string what_it_was_given() const {
        const std::uint64_t bytes = resident_memory_bytes();
        constexpr std::uint64_t mib = std::uint64_t{1} << 20;
        if (allocation_.number.empty())
            return fmt::format(", {}; hand it over again on a machine that has more", memory_text(bytes));
        return fmt::format(
            ", {}; handed over again it is given twice as much, or what you say: --sbatch-option mem={}M",
            memory_text(bytes), 2 * bytes / mib);
    }

    /// Where this task was asked to stop because its time ends.
    [[nodiscard]] std::optional<SlurmTime> time_that_is_over() const {
        constexpr double soon_s =
            180;  // asked a minute before (slurm_script.h), or up to one more; and saving took some
        if (!progress_.cancelled() || allocation_.task.empty()) return std::nullopt;
        const auto time = slurm_time(allocation_.task);
        return time && time->left_s <= soon_s ? time : std::nullopt;
    }

    [[nodiscard]] static std::string time_it_was_given(const SlurmTime& time) {
        const double minutes = std::ceil(time.limit_s / 60);
        return fmt::format(
            "; its time is over, {:.0f} min; hand it over again with more: --sbatch-option time={:.0f}, "
            "twice as much",
            minutes, 2 * minutes);
    }

    /// Others may work on it still.
    void leave(JobState& state) const {
        if (state.runner && (state.runner->host != runner_.host || state.runner->pid != runner_.pid)) return;
        state.runner.reset();
        if (state.phase == JobPhase::running) state.phase = JobPhase::queued;
    }

    JobResult result(ExitCode code, const std::string& message) const {
        io::JsonWriter json;
        json.begin_object().add("format", "voxtone-task").add("version", 1).add("job", job_.name);
        json.add("stage", name_of(stage_.stage)).add("task", index_).add("tasks", stage_.tasks);
        json.add("exit_code", static_cast<int>(code)).add("message", message).end_object();
        return {json.text(), fmt::format("{}: {}: {}\n", job_.name, stage_text(), message), code};
    }

    const TaskOptions& options_;
    Progress& progress_;
    BatchFolder batch_;
    SubmissionFolder files_;
    PlannedJob job_;
    Submission submission_;
    ChainStage stage_;
    SlurmAllocation allocation_;  ///< of Slurm's that this task was submitted for; empty: of none
    int index_;
    JobRunner runner_;
    std::size_t steps_before_ = 0;  ///< of its loop, as it was saved
};

std::string text_of_starved(const Submission& submission, TaskStage stage) {
    std::uint64_t bytes = 0;
    for (const SubmittedStage& submitted : submission.stages)
        if (submitted.stage == stage) bytes = submitted.memory_bytes;
    return fmt::format(
        "{}: Slurm ended it for memory: it took more than {}it was given; handed over again it is given twice as much",
        name_of(stage), bytes > 0 ? fmt::format("the {} that ", memory_text(bytes)) : std::string());
}

/// Of a job that nobody works on any more.
void settle(JobState& state, const BatchFolder& batch, const Submission& submission, Progress& progress) {
    if (state.phase == JobPhase::done || state.phase == JobPhase::failed) return;
    try {
        const PlannedJob job = handed_over_job(batch, submission.job);
        if (holds_job(job.out, job, &progress)) return note_stack(state, batch, job, submission, progress);
    } catch (const Cancelled&) {
        throw;
    } catch (const Error&) {
        // It is told as failed.
    }
    const SubmissionFolder files(batch);
    if (const auto stage = starved_stage(files, submission)) {
        note_starved(files, submission.job, *stage);
        return note_failed(state, static_cast<int>(ExitCode::unfinished), text_of_starved(submission, *stage));
    }
    const std::string before = state.message.empty() ? "" : fmt::format("; before that: {}", state.message);
    note_failed(
        state, state.exit_code != 0 ? state.exit_code : static_cast<int>(ExitCode::try_again),
        fmt::format("its tasks ended before it was done ({}); what they{} said, in batch/slurm/{}, may say "
                    "why; hand it over again to go on{}",
                    submission.text(), submission.numbers().empty() ? "" : " and Slurm", submission.job, before));
}

/// Where squeue is not on the nodes, or none of these was submitted to Slurm, nothing is known to work on any job: what
/// does notes itself again.
std::set<std::string> queue_for_closing(const std::vector<Submission>& submissions, Progress& progress) {
    if (std::none_of(submissions.begin(), submissions.end(), [](const auto& one) { return !one.numbers().empty(); }))
        return {};
    constexpr int tries = 6;
    constexpr std::chrono::seconds between(10);
    for (int attempt = 1;; ++attempt) {
        try {
            return slurm_queue().numbers;
        } catch (const FileError&) {  // it says that nothing is submitted, and nothing was to be
            progress.warn(named_warning(
                "queue-unknown",
                "squeue, which tells what still runs, is not on this machine or finds no cluster: jobs without a stack "
                "are noted as failed, and what still runs notes itself again"));
            return {};
        } catch (const TryAgain&) {
            if (attempt == tries) throw;
            progress.check_cancelled();
            std::this_thread::sleep_for(between);
        }
    }
}

}  // namespace

JobResult run_cluster_task(const TaskOptions& options, Progress& progress) {
    if (options.shard.has_value() != (options.stage == TaskStage::layers))
        throw UsageError("--shard: says which task of the stage `layers` is to be done, and of no other");
    return ClusterTask(options, progress).run();
}

JobResult close_cluster_batch(const fs::path& out, Progress& progress) {
    const BatchFolder batch = BatchFolder::open(out);
    const std::vector<Submission> submissions = SubmissionFolder(batch).all();
    const std::set<std::string> queue = queue_for_closing(submissions, progress);
    for (const Submission& submission : submissions) {
        progress.check_cancelled();
        const std::vector<std::string> numbers = submission.numbers();
        if (std::any_of(numbers.begin(), numbers.end(), [&](const auto& number) { return queue.contains(number); }))
            continue;
        change_state(batch, submission.job, progress,
                     [&](JobState& state) { settle(state, batch, submission, progress); });
    }
    summarise_batch(batch, progress);
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-batch-closed").add("version", 1).add("out", out.string()).end_object();
    return {json.text(), fmt::format("{}: all tasks have ended\n", out.string()), ExitCode::done};
}

}  // namespace voxtone::farm

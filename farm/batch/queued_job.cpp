// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/queued_job.h"

#include <algorithm>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/control_group.h"
#include "base/error.h"
#include "base/machine_memory.h"
#include "base/warning.h"
#include "farm/batch/job_ending.h"
#include "farm/batch/job_log.h"
#include "farm/batch/job_result.h"
#include "io/files/file_digest.h"
#include "io/programs/build_identity.h"
#include "slicer/options/command_words.h"
#include "slicer/part/loop_checkpoint.h"

namespace voxtone::farm {

namespace fs = std::filesystem;

std::uint64_t memory_to_share(const BatchOptions& options) {
    return options.memory_bytes > 0 ? options.memory_bytes : resident_memory_bytes();
}

QueuedJob::QueuedJob(BatchContext& context, PlannedJob job, std::size_t number)
    : context_(context), job_(std::move(job)) {
    const std::optional<JobState> known = context_.folder.state_of(job_.name);
    weight_ = weigh(job_.options, job_.command, known ? &*known : nullptr);
    if (known) {
        state_ = *known;
        for (const auto& [file, digest] : known->inputs) io::file_digests().learn(file, digest);
    }
    state_.name = job_.name;
    state_.number = number;
    if (is_unchanged(known)) {
        unchanged_ = true;
        stage_ = Stage::done;
        notify(JobEvent::Kind::unchanged);
        context_.folder.sweep_lock(job_.name);
        // It may have been killed between a result and what was to follow it.
        if (state_.after && !state_.after->over && !context_.options.after.empty()) {
            lock_ = context_.folder.lock(job_.name);
            if (lock_) follow();
        }
        return;
    }
    claim_folder();
    if (state_.command != job_.command) state_.expected_cpu_s = 0;
    was_weighed_ = state_.expected_cpu_s > 0;
    state_.command = job_.command;
    if (known && known->phase != JobPhase::done) return;
    state_.phase = JobPhase::queued;
    publish();
}

/// What of the job's folder is made by us may be replaced by us.
void QueuedJob::claim_folder() {
    if (!state_.folder_is_ours) state_.folder_is_ours = is_missing_or_empty(job_.out);
}

bool QueuedJob::is_unchanged(const std::optional<JobState>& known) {
    return known && known->phase == JobPhase::done && known->program == io::build_identity() &&
           holds_job(job_.out, job_, &context_.progress);
}

/// As the plan has it, and what the state of its folder asks for.
std::vector<std::string> QueuedJob::words_to_start() const {
    std::vector<std::string> arguments = job_.command;
    const bool same_program = state_.program.empty() || state_.program == io::build_identity();
    if (waits_to_go_on(job_.out, job_))
        arguments.emplace_back("--resume");
    else if (state_.folder_is_ours && !is_missing_or_empty(job_.out) &&
             !(same_program && holds_job(job_.out, job_, &context_.progress)))
        arguments.emplace_back("--overwrite");
    if (weight_.threads == 0) arguments.insert(arguments.end(), {"--threads", std::to_string(threads_)});
    return arguments;
}

void QueuedJob::begin_to_weigh() {
    was_weighed_ = true;
    const fs::path log = context_.folder.log_file(job_.name);
    const std::vector<std::string> arguments = estimate_words(job_.command);
    std::vector<std::string> shown{context_.options.program.string()};
    shown.insert(shown.end(), arguments.begin(), arguments.end());
    try {
        append_line(log, fmt::format("== {} {}", utc_now(), slicer::shell_line(shown)));
        log_begin_ = log_size(log);
        process_ = std::make_unique<JobProcess>(ProcessStart{context_.options.program, arguments, {}, log, -1});
        stage_ = Stage::weighing;
    } catch (const Error&) {
        weight_.bound = false;  // whatever it is will be told when the job itself is started
    }
}

void QueuedJob::take_end_of_weighing() {
    stage_ = Stage::waiting;
    if (stopping_) return;
    weight_ = weigh_by_estimate(weight_, last_line(context_.folder.log_file(job_.name), log_begin_, estimate_begin));
    state_.expected_cpu_s = weight_.cpu_s;
    note_expected_time();
}

/// For who asks how far the batch is. Where another batch works on it, that is not told what it takes.
void QueuedJob::note_expected_time() {
    if (state_.expected_cpu_s <= 0) return;
    try {
        const auto lock = context_.folder.lock(job_.name);
        if (!lock) return;
        JobState known = context_.folder.state_of(job_.name).value_or(state_);
        known.expected_cpu_s = state_.expected_cpu_s;
        context_.folder.publish(known);
    } catch (const Error& error) {
        notify(JobEvent::Kind::warned,
               named_warning("not-noted", fmt::format("its state could not be written: {}", error.what())));
    }
}

void QueuedJob::warn_that_it_runs_alone(std::uint64_t memory_there_is) const {
    if (!weight_.is_known())
        return notify(JobEvent::Kind::warned,
                      named_warning("runs-alone", "how much memory it needs cannot be told beforehand: it runs alone"));
    notify(JobEvent::Kind::warned,
           named_warning("runs-alone", fmt::format("may need {} of memory, more than the {} there are: it runs alone",
                                                   memory_text(weight_.memory_bytes), memory_text(memory_there_is))));
}

void QueuedJob::start(int threads) {
    constexpr double look_again_s = 0.5;
    since_pause_ = Stopwatch();
    pause_s_ = look_again_s;
    since_start_ = Stopwatch();
    try {
        take_lock_and_run(threads);
    } catch (const Cancelled&) {
        throw;
    } catch (const TryAgain& error) {
        take_step(next_step({JobEnding::Kind::again, static_cast<int>(error.exit_code()), error.what()}, attempts()));
    } catch (const Error& error) {
        fail(static_cast<int>(error.exit_code()), error.what());
    }
}

void QueuedJob::take_lock_and_run(int threads) {
    ++tries_;
    lock_ = context_.folder.lock(job_.name);
    if (!lock_) {
        --tries_;
        if (!noted_elsewhere_) notify(JobEvent::Kind::elsewhere);
        noted_elsewhere_ = true;
        return;
    }
    if (!lock_->doubt().empty()) notify(JobEvent::Kind::warned, named_warning("lock-doubt", lock_->doubt()));
    // What another batch has made of it since.
    if (const auto known = context_.folder.state_of(job_.name)) {
        if (is_unchanged(known)) {
            state_ = *known;
            unchanged_ = true;
            notify(JobEvent::Kind::unchanged);
            leave(Stage::done);
            return;
        }
        state_.folder_is_ours = state_.folder_is_ours || known->folder_is_ours;
    }
    threads_ = weight_.threads > 0 ? weight_.threads : threads;
    run(words_to_start());
}

void QueuedJob::run(const std::vector<std::string>& arguments) {
    const fs::path log = context_.folder.log_file(job_.name);
    std::vector<std::string> shown{context_.options.program.string()};
    shown.insert(shown.end(), arguments.begin(), arguments.end());
    append_line(log, fmt::format("== {} {}", utc_now(), slicer::shell_line(shown)));
    log_begin_ = log_size(log);
    began_ns_ = now_ns();
    oom_kills_before_ = cgroup_oom_kills();
    steps_before_ = slicer::LoopCheckpoint::saved_steps(job_.out);
    process_ =
        std::make_unique<JobProcess>(ProcessStart{context_.options.program, arguments, {}, log, lock_->descriptor()});
    stage_ = Stage::running;
    note_start(state_, {io::host_name(), process_->pid(), process_->start_time(), utc_now()}, tries_, threads_);
    state_.command = job_.command;
    publish();
    context_.view.notify({JobEvent::Kind::started, job_.name, {}, 0, tries_, threads_, 0});
}

void QueuedJob::poll() {
    if (!process_) return;
    const std::optional<ProcessEnd> end = process_->ended();
    if (!end) return;
    process_.reset();
    if (stage_ == Stage::weighing)
        take_end_of_weighing();
    else if (stage_ == Stage::following)
        take_end_of_follower(*end);
    else
        take_end_of_job(*end);
}

Attempts QueuedJob::attempts() const {
    return {tries_, context_.options.retries, stopping_, !has_got_more_, state_.attempts_that_got_on};
}

void QueuedJob::note_whether_it_got_on() {
    if (slicer::LoopCheckpoint::saved_steps(job_.out) > steps_before_) ++state_.attempts_that_got_on;
}

void QueuedJob::take_end_of_job(const ProcessEnd& end) {
    const std::string said = last_words(context_.folder.log_file(job_.name), log_begin_);
    const JobEnding ending = ending_of(end, said, stopping_, cgroup_oom_kills() - oom_kills_before_,
                                       std::min(weight_.memory_bytes, memory_to_share(context_.options)));
    note_whether_it_got_on();
    try {
        take_step(next_step(ending, attempts()));
    } catch (const TryAgain& error) {
        take_step(next_step({JobEnding::Kind::again, static_cast<int>(error.exit_code()), error.what()}, attempts()));
    } catch (const Error& error) {
        fail(static_cast<int>(error.exit_code()), fmt::format("what it left cannot be read: {}", error.what()));
    }
}

/// Throws Error where its stack is to be taken and cannot be.
void QueuedJob::take_step(const NextStep& step) {
    switch (step.kind) {
        case NextStep::Kind::finish:
            return finish_stack();
        case NextStep::Kind::with_more:
            has_got_more_ = true;
            weight_ = with_more_memory(weight_);
            return wait_again(step, JobEvent::Kind::again);
        case NextStep::Kind::again:
            return wait_again(step, JobEvent::Kind::again);
        case NextStep::Kind::put_aside:
            return wait_again(step, JobEvent::Kind::stopped);
        case NextStep::Kind::fail_with_stack:
            read_stack();
            break;
        case NextStep::Kind::fail:
            break;
    }
    fail(step.exit_code, step.message);
}

/// Throws Error where that cannot be.
void QueuedJob::read_stack() {
    const std::string no_picture = take_stack(job_.out, began_ns_, context_.folder.picture_file(job_.name), state_);
    if (!no_picture.empty()) notify(JobEvent::Kind::warned, named_warning("not-noted", no_picture));
}

/// Throws Error where what was made, or that it was, cannot be kept.
void QueuedJob::finish_stack() {
    read_stack();
    note_done(state_);
    if (!context_.options.after.empty()) state_.after = AfterState{};
    context_.folder.publish(state_);  // a result of which no file tells would be forgotten: where it cannot be, again
    notify(JobEvent::Kind::done);
    tell_losses();
    if (state_.after && !stopping_)
        follow();
    else
        leave(Stage::done);
}

void QueuedJob::tell_losses() const {
    for (const std::string& lost : lost_colours(*state_.figures)) notify(JobEvent::Kind::warned, lost);
}

void QueuedJob::fail(int exit_code, const std::string& message) {
    note_failed(state_, exit_code, message);
    publish();
    notify(JobEvent::Kind::failed, message);
    leave(Stage::failed);
}

void QueuedJob::wait_again(const NextStep& step, JobEvent::Kind event) {
    note_waiting(state_, step.exit_code, step.message);
    publish();
    notify(event, step.message);
    if (event == JobEvent::Kind::again) {
        constexpr double longest_s = 60;
        since_pause_ = Stopwatch();
        pause_s_ = std::min(longest_s, context_.options.backoff_s * double(1 << std::min(tries_ - 1, 10)));
    }
    leave(Stage::waiting);
}

/// Runs the command that follows a result, its state on stdin.
void QueuedJob::follow() {
    const fs::path log = context_.folder.log_file(job_.name);
    append_line(log, fmt::format("== {} --after: {}", utc_now(), context_.options.after));
    const std::vector<std::string> arguments{"-c", context_.options.after};
    const std::vector<std::string> lost = state_.figures ? lost_colours(*state_.figures) : std::vector<std::string>();
    const std::vector<std::string> variables{"VOXTONE_JOB=" + job_.name,
                                             fmt::format("VOXTONE_LOST_COLOURS={}", fmt::join(lost, "\n"))};
    process_ = std::make_unique<JobProcess>(
        ProcessStart{"/bin/sh", arguments, context_.folder.state_file(job_.name), log, -1, variables});
    stage_ = Stage::following;
}

void QueuedJob::take_end_of_follower(const ProcessEnd& end) {
    leave(Stage::done);
    if (stopping_ && end.exit_code != 0) return;  // it is run again when the batch goes on
    state_.after = AfterState{true, end.exit_code};
    publish();
    if (end.exit_code == 0) return;
    notify(JobEvent::Kind::warned,
           named_warning("after-failed",
                         fmt::format("the command of --after failed ({}); the result stands. What it said is in {}",
                                     end.signal ? fmt::format("signal {}", end.signal)
                                                : fmt::format("exit code {}", end.exit_code),
                                     context_.folder.log_file(job_.name).string())));
}

void QueuedJob::leave(Stage stage) {
    stage_ = stage;
    threads_ = 0;
    lock_.reset();
}

void QueuedJob::publish() {
    try {
        context_.folder.publish(state_);
    } catch (const Error& error) {
        notify(JobEvent::Kind::warned,
               named_warning("not-noted", fmt::format("its state could not be written: {}", error.what())));
    }
}

void QueuedJob::notify(JobEvent::Kind kind, const std::string& message) const {
    context_.view.notify({kind, job_.name, message, state_.exit_code, tries_, threads_, since_start_.total()});
}

void QueuedJob::ask_to_stop(int signal) {
    stopping_ = true;
    if (process_) process_->send(signal);
}

BatchSnapshot::Running QueuedJob::snapshot() const {
    std::string text = tail_of_log(context_.folder.log_file(job_.name), log_begin_);
    text.erase(text.find_last_not_of(" \n") + 1);
    const std::size_t line = text.rfind('\n');
    return {job_.name, since_start_.total(), line == std::string::npos ? text : text.substr(line + 1)};
}

}  // namespace voxtone::farm

// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/cluster/slurm_job.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include <fmt/core.h>

#include "base/counted.h"
#include "base/error.h"
#include "farm/batch/batch_folder.h"
#include "farm/batch/job_result.h"
#include "farm/cluster/chain_estimate.h"
#include "farm/cluster/held_jobs.h"
#include "farm/cluster/job_record.h"
#include "farm/cluster/slurm_commands.h"
#include "farm/cluster/slurm_entry.h"
#include "farm/cluster/slurm_joins.h"
#include "farm/cluster/slurm_lanes.h"
#include "farm/cluster/slurm_script.h"
#include "farm/cluster/stage_memory.h"
#include "slicer/options/command_words.h"

namespace voxtone::farm {

namespace {

namespace fs = std::filesystem;

/// What is there of a batch already, looked at without writing.
class EarlierSubmissions {
public:
    EarlierSubmissions(const std::optional<BatchFolder>& batch, const SlurmQueue& queue)
        : batch_(batch), queue_(queue) {}

    void find_state(SlurmEntry& entry, const Progress& progress) {
        if (!batch_) return;
        if (is_done(*batch_, entry.job, progress)) {
            entry.state = EntryState::unchanged;
            return;
        }
        const std::optional<JobState> known = batch_->state_of(entry.job.name);
        if (!known) return;
        auto before = SubmissionFolder(*batch_).read(entry.job.name);
        if (!before || !is_in_queue(*before)) return;
        entry.submission = *std::move(before);
        // What was not accepted whole, or is planned otherwise now, is cancelled when it is submitted anew.
        if (!entry.submission.complete || known->command != entry.job.command) return;
        entry.state = EntryState::queued;
        entry.message = hold_text(entry.submission, queue_);
    }
    /// As a local batch gives more to what the kernel killed.
    void give_more_memory_to(SlurmEntry& entry) const {
        if (!batch_ || entry.state != EntryState::left) return;
        const auto known = batch_->state_of(entry.job.name);
        const auto before = SubmissionFolder(*batch_).read(entry.job.name);
        if (!known || !before || known->command != entry.job.command) return;
        const std::string given = give_more_memory(entry.chain, *before);
        if (!given.empty()) entry.message += (entry.message.empty() ? "" : "; ") + given;
    }

private:
    [[nodiscard]] bool is_in_queue(const Submission& submission) const {
        const std::vector<std::string> numbers = submission.numbers();
        return std::any_of(numbers.begin(), numbers.end(),
                           [&](const std::string& number) { return queue_.numbers.contains(number); });
    }

    const std::optional<BatchFolder>& batch_;
    const SlurmQueue& queue_;
};

/// One that cannot be estimated cannot be sliced.
void estimate(SlurmEntry& entry, const SlurmOptions& options, const BatchFolder* written, Progress& progress) {
    ChainEstimate made = estimate_chain(entry.job, options.chain, progress);
    entry.chain = std::move(made.chain);
    entry.message = std::move(made.message);
    entry.exit_code = made.exit_code;
    if (entry.exit_code == 0) return;
    entry.state = EntryState::failed;
    if (written) note_failure(*written, entry.job, entry.number, {{}, entry.message, entry.exit_code}, progress);
}

/// How jobs get into the queue: by sbatch, or, dry, into a text.
class Submitting {
public:
    Submitting(const SlurmOptions& options, const SlurmConfig& config, const BatchFolder* batch, const fs::path& out)
        : options_(options),
          config_(config),
          batch_(batch),
          frame_{options.program, out, options.retries},
          folder_(out / "batch") {}

    /// All stages, or none: throws Error where one is refused.
    void submit(SlurmEntry& entry, const Lane& lane) {
        std::vector<std::string> before;
        for (const ChainStage& stage : entry.chain.stages) {
            SubmittedStage& made = entry.submission.stages.emplace_back(SubmittedStage{
                stage.stage, stage.arguments, stage.tasks, {}, stage.memory_bytes, false, stage.is_raised});
            const Dependencies after =
                with_joins({before, before.empty() ? lane.before : std::vector<std::string>()}, made.numbers, entry);
            const std::string text = stage_script(frame_, entry.job.name, stage);
            const fs::path script = script_of(entry.job.name, stage.stage);
            if (batch_) SubmissionFolder(*batch_).write_script(script, text);
            std::string shown;
            before = submit_parts(entry, stage, script, after, lane.throttle, made.numbers, shown);
            if (!batch_) entry.scripts += shown + text + "\n";
        }
    }

    /// What waits for all of these to end.
    std::string submit_last(std::vector<std::string> numbers, SlurmEntry& shown_with) {
        std::vector<std::string> joins;
        try {
            const Dependencies after = with_joins({{}, std::move(numbers)}, joins, shown_with);
            const std::string text = last_script(frame_);
            const fs::path script = folder_ / "slurm-last.sh";
            const auto arguments =
                sbatch_words(script, folder_, {}, 0, after, "slurm/last.%j.out", options_.sbatch_words);
            if (!batch_) {
                shown_with.scripts += shown_call(arguments) + text;
                return {};
            }
            SubmissionFolder(*batch_).write_script(script, text);
            return submit_to_slurm(arguments);
        } catch (const Error&) {
            cancel_in_slurm(joins);
            throw;
        }
    }

private:
    /// The numbers of the stage's parts; all that is submitted is noted in `noted` at once.
    std::vector<std::string> submit_parts(SlurmEntry& entry, const ChainStage& stage, const fs::path& script,
                                          const Dependencies& stage_after, int throttle,
                                          std::vector<std::string>& noted, std::string& shown) {
        std::vector<std::string> parts;
        for (const ArrayPart& part : array_parts(stage.tasks, config_.max_array_size)) {
            Dependencies after = stage_after;
            // Parts of one array share its throttle: one after the other.
            if (throttle > 0 && !parts.empty()) after.ended.push_back(parts.back());
            const auto arguments = sbatch_words(script, folder_, part, throttle, after,
                                                output_of(entry.job.name, stage.stage, part), options_.sbatch_words);
            shown += shown_call(arguments);
            parts.push_back(number_of(arguments, fmt::format("{}-{}", entry.job.name, name_of(stage.stage))));
            noted.push_back(parts.back());
            if (batch_) SubmissionFolder(*batch_).write(entry.submission);
        }
        return parts;
    }
    /// The same in as few numbers as one word of sbatch holds. What is submitted for that is added to `noted`.
    Dependencies with_joins(Dependencies after, std::vector<std::string>& noted, SlurmEntry& shown_with) const {
        const auto join_as = [&](std::vector<std::string> Dependencies::*kind) {
            after.*kind = joined(after.*kind, [&](std::span<const std::string> some) {
                Dependencies of_join;
                (of_join.*kind).assign(some.begin(), some.end());
                noted.push_back(submit_join(of_join, noted.size() + 1, shown_with));
                return noted.back();
            });
        };
        join_as(&Dependencies::succeeded);
        join_as(&Dependencies::ended);
        return after;
    }
    std::string submit_join(const Dependencies& after, std::size_t count, SlurmEntry& shown_with) const {
        const fs::path script = folder_ / "slurm-join.sh";
        const auto arguments = sbatch_words(script, folder_, {}, 0, after, "/dev/null", options_.sbatch_words);
        if (batch_)
            SubmissionFolder(*batch_).write_script(script, join_script());
        else
            shown_with.scripts += shown_call(arguments) + join_script();
        return number_of(arguments, fmt::format("{}-join-{}", shown_with.job.name, count));
    }
    [[nodiscard]] fs::path script_of(const std::string& job, TaskStage stage) const {
        return folder_ / "slurm" / job / fmt::format("{}.sh", name_of(stage));
    }
    static std::string shown_call(const std::vector<std::string>& arguments) {
        return "# ==> sbatch --parsable " + slicer::shell_line(arguments) + "\n";
    }
    [[nodiscard]] std::string number_of(const std::vector<std::string>& arguments, const std::string& of) const {
        return batch_ ? submit_to_slurm(arguments) : "NUMBER-OF-" + of;
    }

    const SlurmOptions& options_;
    const SlurmConfig& config_;
    const BatchFolder* batch_;  ///< null: nothing is written
    ScriptFrame frame_;
    fs::path folder_;
};

/// Into the queue, whole, and noted; or not at all.
void hand_over(SlurmEntry& entry, const Lane& lane, std::size_t jobs, const BatchFolder& batch,
               Submitting& submitting) {
    const auto lock = batch.lock(entry.job.name);  // its tasks wait for it where they begin at once
    if (!lock) {
        entry.state = EntryState::elsewhere;
        return;
    }
    const SubmissionFolder files(batch);
    cancel_in_slurm(entry.submission.numbers());
    JobState state = state_to_hand_over(batch, entry.job, entry.number);
    state.phase = JobPhase::queued;
    state.expected_cpu_s = entry.chain.cpu_s;
    state.message = "is being submitted to Slurm";
    batch.publish(state);
    entry.submission = Submission{entry.job.name, utc_now(), now_ns(), false, {}, jobs};
    PlannedJob settled = entry.job;
    settled.options = options_on_cluster(entry.job.options);
    files.write_job(settled);
    files.write(entry.submission);
    try {
        submitting.submit(entry, lane);
    } catch (const Error& error) {
        cancel_in_slurm(entry.submission.numbers());
        entry.submission.stages.clear();
        files.write(entry.submission);
        state.message = fmt::format("was not submitted: {}", error.what());
        batch.publish(state);
        throw;
    }
    entry.submission.complete = true;
    files.write(entry.submission);
    state.message = fmt::format("submitted: {}", entry.submission.text());
    batch.publish(state);
    entry.state = EntryState::submitted;
}

double lasts_s(const TaskChain& chain, int throttle) {
    double sum = 0;
    for (const ChainStage& stage : chain.stages) {
        const int at_once = throttle > 0 ? std::min(throttle, stage.tasks) : stage.tasks;
        sum += stage.expected_s * std::ceil(double(stage.tasks) / at_once);
    }
    return sum;
}

Lanes lanes_for(const std::vector<SlurmEntry>& entries, int throttle) {
    int widest = 1;
    for (const SlurmEntry& entry : entries)
        if (entry.state == EntryState::left) widest = std::max(widest, entry.chain.shards);
    return {throttle, widest};
}

std::vector<SlurmEntry> entries_of(std::vector<PlannedJob> jobs) {
    std::vector<SlurmEntry> entries;
    for (PlannedJob& job : jobs) {
        SlurmEntry entry;
        entry.job = std::move(job);
        entry.number = entries.size() + 1;
        entries.push_back(std::move(entry));
    }
    return entries;
}

/// The refused job is told with what stands.
[[noreturn]] void refuse(const SlurmEntry& entry, const Error& error, std::size_t submitted, std::size_t jobs) {
    const std::string message = fmt::format(
        "{}: {}; nothing of it is in the queue; {} of {} were submitted before and stay: mend it and run "
        "the same command again for what is left",
        entry.job.name, error.what(), submitted, counted(jobs, "job"));
    throw Error(error.exit_code(), message);
}

/// The jobs that are left, one after the other, until one is refused.
class HandingOver {
public:
    HandingOver(std::vector<SlurmEntry>& entries, const SlurmOptions& options, Submitting& submitting)
        : entries_(entries), submitting_(submitting), lanes_(lanes_for(entries, options.throttle)) {}

    void run(const BatchFolder* batch, Progress& progress) {
        for (SlurmEntry& entry : entries_) {
            if (entry.state != EntryState::left) continue;
            if (progress.cancelled()) return;
            Lane& lane = lanes_.next();
            try {
                batch ? hand_over(entry, lane, entries_.size(), *batch, submitting_) : submitting_.submit(entry, lane);
            } catch (const Error& error) {
                refused_.emplace(&entry, error);
                return;
            }
            if (entry.state == EntryState::elsewhere) continue;
            ++submitted_;
            lane.take(entry.submission.ends(), lasts_s(entry.chain, lane.throttle));
        }
    }
    /// Number of the job that waits for all that waits or runs; empty: nothing does, or one that was submitted before
    /// waits for it still, or it is refused. `waits_since_ns`: what was submitted before that is waited for already.
    std::string close(const BatchFolder* batch, std::int64_t waits_since_ns) {
        std::vector<std::string> numbers;
        bool is_waited_for = true;
        for (const SlurmEntry& entry : entries_) {
            if (entry.state != EntryState::submitted && entry.state != EntryState::queued && batch) continue;
            const std::vector<std::string> ends = entry.submission.ends();
            numbers.insert(numbers.end(), ends.begin(), ends.end());
            is_waited_for = is_waited_for && (ends.empty() || entry.submission.began_ns < waits_since_ns);
        }
        if (is_waited_for) return {};
        try {
            const std::int64_t since_ns = now_ns();
            std::string number = submitting_.submit_last(std::move(numbers), entries_.back());
            if (batch) SubmissionFolder(*batch).write_closing({number, since_ns});
            return number;
        } catch (const Error& error) {
            closing_refused_.emplace(error);
            return {};
        }
    }
    /// Throws what a job, or the one that waits for all, was refused for.
    void expect_none_refused() const {
        if (refused_) refuse(*refused_->first, refused_->second, submitted_, entries_.size());
        if (closing_refused_)
            throw Error(
                closing_refused_->exit_code(),
                fmt::format("{} submitted, but not the task that is to tell what became of them: {}; run the "
                            "same command again to submit it",
                            submitted_ == 1 ? std::string("1 job was") : fmt::format("{} jobs were", submitted_),
                            closing_refused_->what()));
    }

private:
    std::vector<SlurmEntry>& entries_;
    Submitting& submitting_;
    Lanes lanes_;
    std::size_t submitted_ = 0;
    std::optional<std::pair<const SlurmEntry*, Error>> refused_;
    std::optional<Error> closing_refused_;
};

/// Since when what is submitted is not waited for by any job in the queue.
std::int64_t waited_for_since(const BatchFolder& batch, const std::set<std::string>& queue) {
    const auto closing = SubmissionFolder(batch).read_closing();
    return closing && queue.contains(closing->number) ? closing->since_ns : 0;
}

SlurmConfig config_for(bool dry_run, Progress& progress) {
    try {
        return slurm_config();
    } catch (const Error&) {
        if (!dry_run) throw;
        progress.note(fmt::format(
            "no Slurm answers here; the scripts are for one that takes arrays of up to {} tasks, as it does by default",
            SlurmConfig().max_array_size - 1));
        return {};
    }
}

std::optional<BatchFolder> batch_for(const SlurmOptions& options) {
    if (!options.dry_run) return BatchFolder::make(options.out);
    std::error_code none;
    if (fs::exists(options.out / "batch.json", none)) return BatchFolder::open(options.out);
    return std::nullopt;
}

}  // namespace

JobResult run_slurm_job(const PlanOptions& plan, const SlurmOptions& options, Progress& progress) {
    std::vector<PlannedJob> planned = read_plan(plan, &progress);
    const std::string note = note_of_memory(planned);
    std::vector<SlurmEntry> entries = entries_of(std::move(planned));
    const SlurmConfig config = config_for(options.dry_run, progress);
    const SlurmQueue queue = options.dry_run ? SlurmQueue() : slurm_queue();
    const std::optional<BatchFolder> batch = batch_for(options);
    const BatchFolder* const written = options.dry_run ? nullptr : &*batch;
    const fs::path out = fs::absolute(options.out).lexically_normal();
    if (!note.empty()) progress.note(note);
    EarlierSubmissions earlier(batch, queue);
    for (SlurmEntry& entry : entries) {
        progress.check_cancelled();
        earlier.find_state(entry, progress);
        if (entry.state != EntryState::left) continue;
        estimate(entry, options, written, progress);
        earlier.give_more_memory_to(entry);
    }
    Submitting submitting(options, config, written, out);
    HandingOver handing_over(entries, options, submitting);
    handing_over.run(written, progress);
    const std::string last = handing_over.close(written, written ? waited_for_since(*written, queue.numbers) : 0);
    if (written) summarise_batch(*written, progress);
    handing_over.expect_none_refused();
    progress.check_cancelled();
    return slurm_result(entries, out, last, options.dry_run);
}

}  // namespace voxtone::farm

// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/cluster/openjd_job.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "base/counted.h"
#include "base/error.h"
#include "farm/batch/batch_folder.h"
#include "farm/batch/job_result.h"
#include "farm/cluster/chain_estimate.h"
#include "farm/cluster/job_record.h"
#include "farm/cluster/openjd_template.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "slicer/options/command_words.h"

namespace voxtone::farm {

namespace {

namespace fs = std::filesystem;

/// How many there are of each kind.
struct Counts {
    std::size_t left = 0, unchanged = 0, elsewhere = 0, failed = 0;
    ExitCode code = ExitCode::done;
    std::string failures;
};

Submission submission_of(const std::string& job, const TaskChain& chain, std::size_t jobs) {
    Submission submission{job, utc_now(), now_ns(), true, {}, jobs};
    for (const ChainStage& stage : chain.stages)
        submission.stages.push_back(SubmittedStage{stage.stage, stage.arguments, stage.tasks, {}});
    return submission;
}

class TemplateJobs {
public:
    TemplateJobs(const OpenJobOptions& options, std::size_t jobs, Progress& progress)
        : options_(options), jobs_(jobs), batch_(BatchFolder::make(options.out)), progress_(progress) {}

    void take(const PlannedJob& job, std::size_t number) {
        if (is_done(batch_, job, progress_)) {
            ++counts_.unchanged;
            return;
        }
        const ChainEstimate estimate = estimate_chain(job, options_.chain, progress_);
        if (estimate.exit_code != 0) {
            note_failure(batch_, job, number, estimate, progress_);
            if (counts_.failed++ == 0) counts_.code = static_cast<ExitCode>(estimate.exit_code);
            counts_.failures += fmt::format("  {} failed: {}\n", job.name, estimate.message);
            return;
        }
        note(job, number, estimate.chain);
    }
    [[nodiscard]] const std::vector<OpenJobChain>& chains() const { return chains_; }
    [[nodiscard]] const Counts& counts() const { return counts_; }

private:
    /// So that the tasks of the template find it.
    void note(const PlannedJob& job, std::size_t number, const TaskChain& chain) {
        const auto lock = batch_.lock(job.name);
        if (!lock) {
            ++counts_.elsewhere;
            return;
        }
        const SubmissionFolder files(batch_);
        PlannedJob settled = job;
        settled.options = options_on_cluster(job.options);
        files.write_job(settled);
        files.write(submission_of(job.name, chain, jobs_));
        JobState state = state_to_hand_over(batch_, job, number);
        state.phase = JobPhase::queued;
        state.expected_cpu_s = chain.cpu_s;
        state.message = fmt::format("is in {}", options_.file.string());
        batch_.publish(state);
        chains_.push_back({job.name, chain});
        ++counts_.left;
    }

    const OpenJobOptions& options_;
    std::size_t jobs_;  ///< planned
    BatchFolder batch_;
    Progress& progress_;
    std::vector<OpenJobChain> chains_;
    Counts counts_;
};

JobResult result_of(const TemplateJobs& jobs, std::size_t planned, const OpenJobOptions& options) {
    const Counts& counts = jobs.counts();
    std::size_t tasks = 0;
    for (const OpenJobChain& job : jobs.chains())
        for (const ChainStage& stage : job.chain.stages) tasks += std::size_t(stage.tasks);
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-openjd-result").add("version", 1).add("out", options.out.string());
    json.add("template", counts.left > 0 ? options.file.string() : "").add("jobs", planned).add("left", counts.left);
    json.add("tasks", tasks).add("unchanged", counts.unchanged).add("elsewhere", counts.elsewhere);
    json.add("failed", counts.failed).end_object();
    std::string text = fmt::format("{}: {}", options.out.string(), counted(planned, "job"));
    if (counts.unchanged > 0) text += fmt::format(", {} done and unchanged", counts.unchanged);
    if (counts.elsewhere > 0) text += fmt::format(", {} worked on by another batch", counts.elsewhere);
    if (counts.failed > 0) text += fmt::format(", {} failed", counts.failed);
    text += counts.left > 0 ? fmt::format("; {} in {} stand in {}\n", counted(counts.left, "job"),
                                          counted(tasks, "task"), options.file.string())
                            : "; nothing is left to do, and no template was written\n";
    return {json.text(), text + counts.failures, counts.code};
}

}  // namespace

JobResult run_openjd_job(const PlanOptions& plan, const OpenJobOptions& options, Progress& progress) {
    const std::vector<PlannedJob> planned = read_plan(plan, &progress);
    const OpenJobFrame frame{options.program, fs::absolute(options.out).lexically_normal()};
    // What cannot be written is refused before anything is noted.
    std::vector<OpenJobChain> names;
    for (const PlannedJob& job : planned) names.push_back({job.name, {}});
    (void)openjd_template(names, frame);
    if (const std::string note = note_of_memory(planned); !note.empty()) progress.note(note);
    TemplateJobs jobs(options, planned.size(), progress);
    for (std::size_t i = 0; i < planned.size(); ++i) {
        progress.check_cancelled();
        jobs.take(planned[i], i + 1);
    }
    if (!jobs.chains().empty()) io::write_whole_file(options.file, openjd_template(jobs.chains(), frame));
    return result_of(jobs, planned.size(), options);
}

}  // namespace voxtone::farm

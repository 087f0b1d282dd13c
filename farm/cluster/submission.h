// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a batch has handed to Slurm, in OUT/batch/slurm, one folder for each job:
//   NAME/job.json          the job (options/job_file.h)
//   NAME/STAGE.sh          what sbatch was given (slurm_script.h)
//   NAME/submission.json   the stages and their jobs' numbers (data/schema/submission.schema.json)
//   NAME/STAGE-I.log       what task I says, one attempt below the other; no two tasks write into one file
//   NAME/STAGE.NUMBER.out  what Slurm itself says of it
//   .last.json             the job that waits for all others to end
// and beside it OUT/batch/slurm-last.sh and slurm-join.sh.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "farm/batch/batch_folder.h"
#include "farm/cluster/task_chain.h"

namespace voxtone::farm {

struct SubmittedStage {
    TaskStage stage = TaskStage::whole;
    std::vector<std::string> arguments;  ///< as ChainStage::arguments
    int tasks = 1;
    std::vector<std::string> numbers;  ///< of Slurm's jobs; several where one array does not hold all tasks, or where
                                       ///< jobs stand before it that join what it waits for
    std::uint64_t memory_bytes = 0;    ///< that each task was given; 0: not known
    bool is_starved = false;           ///< a task was ended for memory (stage_memory.h)
    bool is_raised = false;            ///< they were given more than their estimate, for that
};

struct Submission {
    std::string job;
    std::string since;          ///< UTC
    std::int64_t began_ns = 0;  ///< the same, as file systems have it
    bool complete = false;      ///< all stages were accepted
    std::vector<SubmittedStage> stages;
    std::size_t jobs = 0;  ///< of the plan that it came from; 0: not known

    /// Of all stages, in their order.
    [[nodiscard]] std::vector<std::string> numbers() const;
    /// Of those at whose end all of its tasks have ended: the last stage, and parts of arrays, each of which may be the
    /// last to end where another has failed.
    [[nodiscard]] std::vector<std::string> ends() const;
    /// "in Slurm (prepare 12, layers 13, merge 14)", or "by Open Job Description": its tasks have no numbers here.
    [[nodiscard]] std::string text() const;
};

/// The job that waits for the ends of all others.
struct Closing {
    std::string number;         ///< in Slurm
    std::int64_t since_ns = 0;  ///< it waits for what was submitted before this
};

class SubmissionFolder {
public:
    explicit SubmissionFolder(const BatchFolder& batch) : batch_(batch.path() / "batch") {}

    /// Of a job.
    [[nodiscard]] std::filesystem::path of(const std::string& job) const { return batch_ / "slurm" / job; }
    [[nodiscard]] std::filesystem::path last_script() const { return batch_ / "slurm-last.sh"; }
    [[nodiscard]] std::filesystem::path join_script() const { return batch_ / "slurm-join.sh"; }
    [[nodiscard]] std::filesystem::path script(const std::string& job, TaskStage stage) const;
    [[nodiscard]] std::filesystem::path job_file(const std::string& job) const { return of(job) / "job.json"; }
    [[nodiscard]] std::filesystem::path task_log(const std::string& job, TaskStage stage, int task) const;

    /// Nothing where there is none, or none that can be read.
    [[nodiscard]] std::optional<Submission> read(const std::string& job) const;
    /// Of every job that has one, by name.
    [[nodiscard]] std::vector<Submission> all() const;
    /// Each is whole, at once. Throw FileError, TryAgain.
    void write(const Submission& submission) const;
    void write_job(const PlannedJob& job) const;
    void write_script(const std::filesystem::path& script, const std::string& text) const;

    /// Nothing where there is none, or none that can be read.
    [[nodiscard]] std::optional<Closing> read_closing() const;
    void write_closing(const Closing& closing) const;

private:
    std::filesystem::path batch_;
};

[[nodiscard]] std::string submission_json(const Submission& submission);

}  // namespace voxtone::farm

// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a batch has handed to Slurm, in OUT/batch/slurm, one folder for each job:
//   NAME/job.json          the job (options/job_file.h)
//   NAME/STAGE.sh          what sbatch was given (slurm_script.h)
//   NAME/submission.json   the stages and their jobs' numbers (data/schema/submission.schema.json)
//   NAME/STAGE-I.log       what task I says while it runs; then it is added to OUT/batch/NAME.log
// and beside it OUT/batch/slurm-last.sh, and OUT/batch/slurm.out with what Slurm itself says of the tasks.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "slicer/batch/batch_folder.h"
#include "slicer/cluster/task_chain.h"

namespace voxtone::slicer {

struct SubmittedStage {
    TaskStage stage = TaskStage::whole;
    std::vector<std::string> words;  ///< as ChainStage::words
    int tasks = 1;
    std::vector<std::string> numbers;  ///< of Slurm's jobs; several where one array does not hold all tasks
};

struct Submission {
    std::string job;
    std::string since;          ///< UTC
    std::int64_t began_ns = 0;  ///< the same, as file systems have it
    bool complete = false;      ///< all stages were accepted
    std::vector<SubmittedStage> stages;

    /// Of all stages, in their order.
    [[nodiscard]] std::vector<std::string> numbers() const;
    /// "in Slurm (prepare 12, layers 13, merge 14)", or "by Open Job Description": its tasks have no numbers here.
    [[nodiscard]] std::string text() const;
};

class SubmissionFolder {
public:
    explicit SubmissionFolder(const BatchFolder& batch) : batch_(batch.path() / "batch") {}

    /// Where Slurm's own output goes.
    [[nodiscard]] const std::filesystem::path& output_folder() const { return batch_; }
    [[nodiscard]] std::filesystem::path slurm_output() const { return batch_ / "slurm.out"; }
    [[nodiscard]] std::filesystem::path last_script() const { return batch_ / "slurm-last.sh"; }
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

private:
    [[nodiscard]] std::filesystem::path of(const std::string& job) const { return batch_ / "slurm" / job; }
    std::filesystem::path batch_;
};

[[nodiscard]] std::string submission_json(const Submission& submission);

}  // namespace voxtone::slicer

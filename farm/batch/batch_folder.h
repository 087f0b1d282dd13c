// SPDX-License-Identifier: GPL-3.0-or-later
//
// The folder of a batch, OUT:
//   OUT/batch.json         says that it is one, and of which version
//   OUT/batch/NAME.json    state of a job (job_state.h)
//   OUT/batch/NAME.log     what its processes said, one run below the other
//   OUT/batch/NAME.png     a small picture of the print
//   OUT/NAME/              what `voxtone slice` makes
//   OUT/index.html, OUT/summary.csv   (batch_summary.h)
// Any number of batches may work on one OUT: each job is held by a lock of its own (io/disk/folder_lock.h), which ends
// with the processes that hold it.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "farm/batch/job_state.h"
#include "io/disk/folder_lock.h"

namespace voxtone::farm {

class BatchFolder {
public:
    /// Takes a folder that is not there, is empty or is a batch's. Throws InputError for any other, also for one of
    /// another version; FileError.
    [[nodiscard]] static BatchFolder make(const std::filesystem::path& out);
    /// One that is there. Throws InputError, FileError.
    [[nodiscard]] static BatchFolder open(const std::filesystem::path& out);

    [[nodiscard]] const std::filesystem::path& path() const { return out_; }
    [[nodiscard]] std::filesystem::path job_folder(const std::string& name) const { return out_ / name; }
    [[nodiscard]] std::filesystem::path state_file(const std::string& name) const;
    [[nodiscard]] std::filesystem::path log_file(const std::string& name) const;
    [[nodiscard]] std::filesystem::path picture_file(const std::string& name) const;

    /// Nothing where there is none, or none that can be read: the job is then done anew.
    [[nodiscard]] std::optional<JobState> state_of(const std::string& name) const;
    /// All that can be read, by number and name.
    [[nodiscard]] std::vector<JobState> states() const;
    /// Under its name at once, whole. Throws FileError, TryAgain.
    void publish(const JobState& state) const;

    /// Nothing where another process holds the job. Throws FileError, TryAgain.
    [[nodiscard]] std::unique_ptr<io::FolderLock> lock(const std::string& name) const;
    /// Of the summary, for those who need not draw it where another does. As `lock`.
    [[nodiscard]] std::unique_ptr<io::FolderLock> lock_summary() const;
    /// Removes the lock's file where a killed process left it.
    void sweep_lock(const std::string& name) const;

private:
    explicit BatchFolder(std::filesystem::path out) : out_(std::move(out)) {}
    [[nodiscard]] std::filesystem::path states_folder() const { return out_ / "batch"; }
    [[nodiscard]] std::unique_ptr<io::FolderLock> lock_file(const std::string& file) const;
    [[nodiscard]] static std::string name_of_lock(const std::string& name) { return "." + name + ".lock"; }

    std::filesystem::path out_;
};

}  // namespace voxtone::farm

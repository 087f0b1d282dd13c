// SPDX-License-Identifier: GPL-3.0-or-later
//
// What sbatch is given: one script a stage of a job (task_chain.h), and its place among the others on the command line.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "farm/cluster/task_chain.h"

namespace voxtone::farm {

/// What all scripts of a batch share.
struct ScriptFrame {
    std::filesystem::path program;  ///< `voxtone`, absolute
    std::filesystem::path out;      ///< of the batch, absolute
    int retries = 5;                ///< of a task that may go another time
};

/// The tasks of an array are numbered from 1; the script's first word, 0 without one, is added to that.
[[nodiscard]] std::string stage_script(const ScriptFrame& frame, const std::string& job, const ChainStage& stage);
/// Of what comes when all has ended: states and summary.
[[nodiscard]] std::string last_script(const ScriptFrame& frame);
/// Of what stands for many in a dependency: it ends at once.
[[nodiscard]] std::string join_script();

/// A part of a stage that is submitted at once.
struct ArrayPart {
    int before = 0;  ///< tasks in the parts before it
    int tasks = 1;
    bool is_array = false;
    bool operator==(const ArrayPart&) const = default;
};
/// `max_array_size`: what Slurm's configuration calls MaxArraySize.
[[nodiscard]] std::vector<ArrayPart> array_parts(int tasks, std::uint32_t max_array_size);

/// Whom a job waits for.
struct Dependencies {
    std::vector<std::string> succeeded;  ///< all of these must have ended well
    std::vector<std::string> ended;      ///< all of these must have ended
};
/// What Slurm itself says of a stage goes there, seen from OUT/batch: a file for each task, as sbatch has it written (a
/// '%' begins a number there).
[[nodiscard]] std::string output_of(const std::string& job, TaskStage stage, const ArrayPart& part);
/// The words behind `sbatch --parsable`. `throttle`: most tasks of the array at once; 0: any number. `more`: words of
/// the user's.
[[nodiscard]] std::vector<std::string> sbatch_words(const std::filesystem::path& script,
                                                    const std::filesystem::path& folder, const ArrayPart& part,
                                                    int throttle, const Dependencies& after, const std::string& output,
                                                    const std::vector<std::string>& more);

}  // namespace voxtone::farm

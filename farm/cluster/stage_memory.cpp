// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/cluster/stage_memory.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>

#include <fmt/core.h>

#include "base/machine_memory.h"
#include "farm/batch/job_log.h"
#include "farm/cluster/slurm_commands.h"

namespace voxtone::farm {

namespace {

namespace fs = std::filesystem;

SubmittedStage* find_stage(Submission& submission, TaskStage stage) {
    const auto found = std::ranges::find(submission.stages, stage, &SubmittedStage::stage);
    return found == submission.stages.end() ? nullptr : &*found;
}

/// "whole.17.out", "layers.17_3.out".
bool is_output_of(const std::string& file, const SubmittedStage& stage) {
    return std::ranges::any_of(stage.numbers, [&](const std::string& number) {
        const std::string begin = fmt::format("{}.{}", name_of(stage.stage), number);
        return file.starts_with(begin) && file.ends_with(".out") &&
               (file[begin.size()] == '.' || file[begin.size()] == '_');
    });
}

}  // namespace

bool tells_of_too_little_memory(const std::string& output) {
    std::string low = output;
    std::ranges::transform(low, low.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c + 32) : c; });
    // Of slurmstepd with OverMemoryKill and before it, of its control groups in several versions.
    constexpr std::array<std::string_view, 5> signs{"exceeded memory limit", "exceeded job memory limit",
                                                    "exceeded step memory limit", "oom-kill", "oom_kill"};
    return std::ranges::any_of(signs, [&](std::string_view sign) { return low.find(sign) != std::string::npos; });
}

std::optional<TaskStage> starved_stage(const SubmissionFolder& files, const Submission& submission) {
    std::error_code none;
    for (const fs::directory_entry& entry : fs::directory_iterator(files.of(submission.job), none)) {
        const std::string file = entry.path().filename().string();
        for (const SubmittedStage& stage : submission.stages)
            if (is_output_of(file, stage) && tells_of_too_little_memory(tail_of_log(entry.path(), 0)))
                return stage.stage;
    }
    for (const SubmittedStage& stage : submission.stages)
        for (const std::string& number : stage.numbers)
            if (ended_out_of_memory(number)) return stage.stage;
    return std::nullopt;
}

void note_starved(const SubmissionFolder& files, const std::string& job, TaskStage stage) {
    std::optional<Submission> now = files.read(job);
    if (!now) return;
    SubmittedStage* const submitted = find_stage(*now, stage);
    if (!submitted || submitted->is_starved) return;
    submitted->is_starved = true;
    files.write(*now);
}

std::string give_more_memory(TaskChain& chain, const Submission& before) {
    std::string given;
    for (ChainStage& stage : chain.stages)
        for (const SubmittedStage& then : before.stages) {
            if (then.stage != stage.stage || !(then.is_starved || then.is_raised)) continue;
            const std::uint64_t had = then.memory_bytes > 0 ? then.memory_bytes : stage.memory_bytes;
            const std::uint64_t wanted = then.is_starved ? 2 * had : had;
            if (wanted <= stage.memory_bytes) continue;
            stage.memory_bytes = wanted;
            stage.is_raised = true;
            given += fmt::format("{}{} is given {}, for it was ended for memory", given.empty() ? "" : "; ",
                                 name_of(stage.stage), memory_text(wanted));
        }
    return given;
}

}  // namespace voxtone::farm

// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/cluster/slurm_script.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/printable.h"
#include "slicer/options/command_words.h"

namespace voxtone::farm {

namespace {

/// Slurm gives a task so long to save itself before its time is over.
constexpr int signal_before_s = 60;

/// A job's name in Slurm's tables: letters, digits and what harms nowhere.
std::string label(const std::string& job, std::string_view stage) {
    std::string text = job;
    for (char& c : text) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
        if (!plain && c != '-' && c != '.' && c != '_') c = '_';
    }
    return fmt::format("{}:{}", text, stage);
}

/// A comment of one line, whatever the words hold.
std::string comment(std::string text) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < ' ') c = '?';
    return "# " + printable(text) + "\n";
}

std::string shell_word(const std::string& word) { return slicer::shell_line(std::array{word}); }

std::string directives(const std::string& name, int cores, std::uint64_t memory_bytes, double limit_s) {
    constexpr std::uint64_t mib = std::uint64_t{1} << 20;
    std::string text;
    const auto add = [&](const std::string& option) { text += "#SBATCH --" + option + "\n"; };
    add("job-name=" + name);
    add("nodes=1");
    add("ntasks=1");
    add(fmt::format("cpus-per-task={}", cores));
    add(fmt::format("mem={}M", (memory_bytes + mib - 1) / mib));
    add(fmt::format("time={}", static_cast<std::uint64_t>(std::ceil(limit_s / 60))));
    add(fmt::format("signal=B:TERM@{}", signal_before_s));
    add("requeue");
    add("kill-on-invalid-dep=yes");
    add("open-mode=append");
    return text;
}

std::string example_of(const ScriptFrame& frame, const ChainStage& stage) {
    std::vector<std::string> arguments{frame.program.string()};
    arguments.insert(arguments.end(), stage.arguments.begin(), stage.arguments.end());
    return slicer::shell_line(arguments) +
           (stage.stage == TaskStage::layers ? fmt::format(" --shard I/{}", stage.tasks) : "");
}

}  // namespace

std::string stage_script(const ScriptFrame& frame, const std::string& job, const ChainStage& stage) {
    const std::string_view name = name_of(stage.stage);
    std::string text = "#!/bin/sh\n";
    text += comment(fmt::format("Job {} of a batch: {}{}. Each task sees to it that this is done:", job, name,
                                stage.tasks > 1 ? fmt::format(", {} tasks", stage.tasks) : ""));
    text += comment(example_of(frame, stage));
    text += directives(label(job, name), stage.cores, stage.memory_bytes, stage.limit_s);
    const std::vector<std::string> arguments{
        frame.program.string(), "task",      frame.out.string(),           "--job=" + job, "--stage",
        std::string(name),      "--retries", std::to_string(frame.retries)};
    text += "exec " + slicer::shell_line(arguments);
    if (stage.stage == TaskStage::layers)
        text += fmt::format(" --shard \"$((${{SLURM_ARRAY_TASK_ID:-1}} + ${{1:-0}}))/{}\"", stage.tasks);
    return text + "\n";
}

std::string last_script(const ScriptFrame& frame) {
    constexpr std::uint64_t memory_bytes = std::uint64_t{512} << 20;
    constexpr double limit_s = 1800;
    std::string text = "#!/bin/sh\n";
    text += comment("When all tasks of a batch have ended: what became of its jobs, and the summary.");
    text += directives("voxtone:last", 1, memory_bytes, limit_s);
    return text +
           fmt::format("exec {} task {} --last\n", shell_word(frame.program.string()), shell_word(frame.out.string()));
}

std::string join_script() {
    constexpr std::uint64_t memory_bytes = std::uint64_t{64} << 20;
    constexpr double limit_s = 60;
    return "#!/bin/sh\n" + comment("Stands for many jobs where one waits for all of them; there is nothing to do.") +
           directives("voxtone:join", 1, memory_bytes, limit_s) + "exit 0\n";
}

std::string output_of(const std::string& job, TaskStage stage, const ArrayPart& part) {
    std::string folder = "slurm/";
    for (const char c : job) folder += c == '%' ? std::string("%%") : std::string(1, c);
    return fmt::format("{}/{}.{}.out", folder, name_of(stage), part.is_array ? "%A_%a" : "%j");
}

std::vector<ArrayPart> array_parts(int tasks, std::uint32_t max_array_size) {
    const int most = max_array_size < 2 ? 1 : int(std::min<std::uint32_t>(max_array_size - 1, 1 << 30));
    std::vector<ArrayPart> parts;
    for (int before = 0; before < tasks; before += most)
        parts.push_back({before, std::min(most, tasks - before), max_array_size >= 2 && tasks > 1});
    return parts;
}

std::vector<std::string> sbatch_words(const std::filesystem::path& script, const std::filesystem::path& folder,
                                      const ArrayPart& part, int throttle, const Dependencies& after,
                                      const std::string& output, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"--chdir=" + folder.string(), "--output=" + output};
    if (part.is_array)
        arguments.push_back(fmt::format("--array=1-{}{}", part.tasks,
                                        throttle > 0 && throttle < part.tasks ? fmt::format("%{}", throttle) : ""));
    std::vector<std::string> conditions;
    if (!after.succeeded.empty()) conditions.push_back(fmt::format("afterok:{}", fmt::join(after.succeeded, ":")));
    if (!after.ended.empty()) conditions.push_back(fmt::format("afterany:{}", fmt::join(after.ended, ":")));
    if (!conditions.empty()) arguments.push_back(fmt::format("--dependency={}", fmt::join(conditions, ",")));
    arguments.insert(arguments.end(), more.begin(), more.end());
    arguments.push_back(script.string());
    if (part.before > 0) arguments.push_back(std::to_string(part.before));
    return arguments;
}

}  // namespace voxtone::farm

// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/cluster/slurm_entry.h"

#include <algorithm>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/counted.h"
#include "base/error.h"
#include "base/progress_bar.h"
#include "io/files/json_writer.h"

namespace voxtone::farm {

namespace {

std::size_t count_of(std::span<const SlurmEntry> entries, EntryState state) {
    return std::size_t(
        std::count_if(entries.begin(), entries.end(), [&](const SlurmEntry& entry) { return entry.state == state; }));
}

/// By stage; a dry run and what was submitted before know no numbers of it.
std::vector<std::string> numbers_of(const SlurmEntry& entry, TaskStage stage) {
    for (const SubmittedStage& submitted : entry.submission.stages)
        if (submitted.stage == stage) return submitted.numbers;
    return {};
}

void add_entry(io::JsonWriter& json, const SlurmEntry& entry) {
    json.begin_object().add("job", entry.job.name).add("state", name_of(entry.state));
    if (!entry.message.empty()) json.add("message", entry.message);
    if (entry.exit_code != 0) json.add("exit_code", entry.exit_code);
    if (entry.state == EntryState::queued) json.add("numbers", entry.submission.numbers());
    json.key("stages").begin_list();
    for (const ChainStage& stage : entry.chain.stages) {
        json.begin_object().add("stage", name_of(stage.stage)).add("tasks", stage.tasks).add("cores", stage.cores);
        json.add("memory_bytes", stage.memory_bytes).add("expected_s", stage.expected_s).add("limit_s", stage.limit_s);
        json.add("numbers", numbers_of(entry, stage.stage)).end_object();
    }
    json.end_list();
    if (!entry.scripts.empty()) json.add("scripts", entry.scripts);
    json.end_object();
}

std::string stage_text(const SlurmEntry& entry, const ChainStage& stage) {
    constexpr double gib = 1 << 30;
    std::string text =
        stage.tasks > 1 ? fmt::format("{} x {}", name_of(stage.stage), stage.tasks) : std::string(name_of(stage.stage));
    if (const auto numbers = numbers_of(entry, stage.stage); !numbers.empty())
        text += fmt::format(" (job {})", fmt::join(numbers, ", "));
    return text + fmt::format(" on {} with {:.1f} GiB, {}", counted(std::uint64_t(stage.cores), "core"),
                              double(stage.memory_bytes) / gib, duration_text(stage.limit_s));
}

std::string entry_text(const SlurmEntry& entry) {
    std::string text = fmt::format("  {}: {}", entry.job.name, name_of(entry.state));
    for (std::size_t i = 0; i < entry.chain.stages.size(); ++i)
        text += (i == 0 ? ": " : "; then ") + stage_text(entry, entry.chain.stages[i]);
    if (!entry.message.empty()) text += ": " + entry.message;
    return text + "\n";
}

}  // namespace

JobResult slurm_result(std::span<const SlurmEntry> entries, const std::filesystem::path& out, const std::string& last,
                       bool dry_run) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-slurm-result").add("version", 1).add("out", out.string());
    json.add("dry_run", dry_run);
    std::string text, scripts;
    ExitCode code = ExitCode::done;
    for (const EntryState state : {EntryState::left, EntryState::submitted, EntryState::queued, EntryState::unchanged,
                                   EntryState::elsewhere, EntryState::failed}) {
        const std::size_t count = count_of(entries, state);
        json.add(name_of(state), count);
        if (count > 0) text += fmt::format(", {} {}", count, name_of(state));
    }
    text = fmt::format("{}: {}{}\n", out.string(), counted(entries.size(), "job"), text);
    json.key("jobs").begin_list();
    for (const SlurmEntry& entry : entries) {
        add_entry(json, entry);
        if (entry.state != EntryState::unchanged) text += entry_text(entry);
        scripts += entry.scripts;
        if (entry.state == EntryState::failed && code == ExitCode::done) code = static_cast<ExitCode>(entry.exit_code);
    }
    json.end_list();
    if (!last.empty()) {
        json.add("last", last);
        text += fmt::format("when all has ended, job {} says what became of it; until then: voxtone status {}\n", last,
                            out.string());
    }
    return {json.end_object().text(), scripts + (dry_run && !scripts.empty() ? "\n" : "") + text, code};
}

}  // namespace voxtone::farm

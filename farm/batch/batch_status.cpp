// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/batch_status.h"

#include <algorithm>
#include <array>
#include <ctime>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "base/counted.h"
#include "base/progress_bar.h"
#include "farm/batch/batch_folder.h"
#include "farm/batch/batch_outlook.h"
#include "io/disk/folder_lock.h"
#include "io/files/json_writer.h"

namespace voxtone::farm {

namespace {

/// As a state is told: what runs here no more is said to be interrupted.
std::string_view word_for(const JobState& state) {
    const bool gone = state.phase == JobPhase::running && state.runner && state.runner->host == io::host_name() &&
                      !lives_here(*state.runner);
    return gone ? "interrupted" : name_of(state.phase);
}

std::string details_of(const JobState& state, std::string_view word) {
    if (word == "interrupted") return "its process is no more; run the batch again to go on";
    if (state.phase == JobPhase::running && state.runner)
        return fmt::format("since {} (host {}, process {})", state.runner->since, state.runner->host,
                           state.runner->pid);
    if (state.phase == JobPhase::failed) return fmt::format("(exit code {}) {}", state.exit_code, state.message);
    if (state.phase != JobPhase::done || !state.figures) return state.message;
    const StackFigures& f = *state.figures;
    double ml = 0;
    for (const auto& [role, of_role] : f.resin_ml) ml += of_role;
    std::string text =
        fmt::format("{:.1f} x {:.1f} x {:.1f} mm, {:.2f} ml", f.size_mm[0], f.size_mm[1], f.size_mm[2], ml);
    if (f.seen_de2000) text += fmt::format(", CIEDE2000 {:.1f}", *f.seen_de2000);
    if (!lost_colours(f).empty()) text += ", LOST colours";
    if (!f.warnings.empty()) text += ", " + counted(f.warnings.size(), "warning");
    text += ", " + duration_text(f.seconds);
    if (state.after && state.after->over && state.after->exit_code != 0)
        text += fmt::format("; its --after failed (exit code {})", state.after->exit_code);
    return text;
}

void add_job(io::JsonWriter& json, const JobState& state, std::string_view word) {
    json.begin_object().add("job", state.name).add("state", word).add("attempts", state.attempts);
    json.add("exit_code", state.exit_code);
    if (!state.message.empty()) json.add("message", state.message);
    if (state.runner)
        json.add("host", state.runner->host).add("pid", state.runner->pid).add("since", state.runner->since);
    if (state.phase == JobPhase::done && state.figures) json.add("content_sha256", state.figures->content_sha256);
    json.end_object();
}

}  // namespace

JobResult batch_status(const std::filesystem::path& out, const std::map<std::string, std::string>& remarks) {
    const BatchFolder folder = BatchFolder::open(out);
    std::vector<JobState> states = folder.states();
    for (JobState& state : states)
        if (const auto remark = remarks.find(state.name);
            remark != remarks.end() && (state.phase == JobPhase::queued || state.phase == JobPhase::running))
            state.message += (state.message.empty() ? "" : "; ") + remark->second;
    constexpr std::array<std::string_view, 5> arguments{"done", "running", "queued", "interrupted", "failed"};
    std::array<std::size_t, arguments.size()> counts{};
    std::size_t widest = 0;
    io::JsonWriter jobs;
    jobs.begin_object().add("format", "voxtone-batch-status").add("version", 1).add("out", folder.path().string());
    std::string lines;
    for (const JobState& state : states) widest = std::max(widest, state.name.size());
    jobs.key("jobs").begin_list();
    for (const JobState& state : states) {
        const std::string_view word = word_for(state);
        ++counts[std::size_t(std::find(arguments.begin(), arguments.end(), word) - arguments.begin())];
        add_job(jobs, state, word);
        lines += fmt::format("  {:<{}}  {:<11}  {}\n", state.name, widest, word, details_of(state, word));
    }
    jobs.end_list();
    std::string text = fmt::format("{}: {}", out.string(), counted(states.size(), "job"));
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        jobs.add(arguments[i], counts[i]);
        if (counts[i] > 0) text += fmt::format(", {} {}", counts[i], arguments[i]);
    }
    if (const auto outlook = batch_outlook(states, double(std::time(nullptr)))) {
        text += "; " + outlook_text(*outlook);
        jobs.key("rest").begin_object().add("jobs", outlook->left).add("measured_jobs", outlook->measured);
        jobs.add("seconds", outlook->seconds).add("least_seconds", outlook->least_s);
        jobs.add("most_seconds", outlook->most_s).end_object();
    }
    return {jobs.end_object().text(), text + "\n" + lines};
}

}  // namespace voxtone::farm

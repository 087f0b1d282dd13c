// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/job_state.h"

#include <ctime>
#include <limits>

#include <fmt/chrono.h>
#include <fmt/core.h>

#include "base/error.h"
#include "base/warning.h"
#include "io/disk/folder_lock.h"
#include "io/files/json_object.h"
#include "io/files/json_writer.h"

namespace voxtone::farm {

namespace {

constexpr std::uint64_t any_count = std::numeric_limits<std::uint64_t>::max();

void write_runner(io::JsonWriter& json, const JobRunner& runner) {
    json.line().key("runner").begin_object().add("host", runner.host).add("pid", runner.pid);
    json.add("start", runner.start).add("since", runner.since).end_object();
}

void write_figures(io::JsonWriter& json, const StackFigures& figures) {
    json.line().key("figures").begin_object().add("content_sha256", figures.content_sha256);
    json.line().add("printer", figures.printer).add("size_mm", figures.size_mm).add("layers", figures.layers);
    json.add("voxels", figures.voxels).line().key("resin_ml").begin_list();
    for (const auto& [role, ml] : figures.resin_ml) json.begin_object().add("role", role).add("ml", ml).end_object();
    json.end_list();
    if (!figures.verdict.empty()) json.line().add("verdict", figures.verdict);
    if (figures.seen_de2000) json.add("seen_de2000", *figures.seen_de2000);
    json.line().add("warnings", figures.warnings);
    if (const auto lost = lost_colours(figures); !lost.empty()) json.line().add("lost_colours", lost);
    json.line().add("seconds", figures.seconds);
    json.add("peak_memory_bytes", figures.peak_memory_bytes).add("output_bytes", figures.output_bytes).end_object();
}

void write_inputs(io::JsonWriter& json, const JobState& state) {
    json.line().key("inputs").begin_list();
    for (const auto& [file, known] : state.inputs) {
        json.line().begin_object().add("file", file).add("sha256", known.sha256).add("size", known.stamp.size);
        json.add("inode", known.stamp.inode).add("modified_ns", known.stamp.modified_ns);
        json.add("changed_ns", known.stamp.changed_ns).end_object();
    }
    json.end_list();
}

JobRunner read_runner(const io::JsonObject& json) {
    json.allow_only({"host", "pid", "start", "since"});
    return {json.text("host"), static_cast<pid_t>(json.integer("pid", 0, std::numeric_limits<pid_t>::max())),
            json.integer("start", 0, any_count), json.text("since")};
}

StackFigures read_figures(const io::JsonObject& json) {
    json.allow_only({"content_sha256", "printer", "size_mm", "layers", "voxels", "resin_ml", "verdict", "seen_de2000",
                     "warnings", "lost_colours", "seconds", "peak_memory_bytes", "output_bytes"});
    StackFigures figures;
    figures.content_sha256 = json.text("content_sha256");
    figures.printer = json.text("printer");
    read_shared_figures(json, figures);
    for (const io::JsonObject& resin : json.objects("resin_ml"))
        figures.resin_ml.emplace_back(resin.text("role"), resin.number("ml", 0, 1e12));
    if (json.has("verdict")) figures.verdict = json.text("verdict");
    if (json.has("seen_de2000")) figures.seen_de2000 = json.number("seen_de2000", 0, 1e3);
    return figures;
}

std::pair<std::string, io::KnownDigest> read_input(const io::JsonObject& json) {
    json.allow_only({"file", "sha256", "size", "inode", "modified_ns", "changed_ns"});
    constexpr std::uint64_t latest = std::numeric_limits<std::int64_t>::max();
    io::KnownDigest known;
    known.sha256 = json.text("sha256");
    known.stamp = {json.integer("size", 0, any_count), json.integer("inode", 0, any_count),
                   static_cast<std::int64_t>(json.integer("modified_ns", 0, latest)),
                   static_cast<std::int64_t>(json.integer("changed_ns", 0, latest))};
    return {json.text("file"), known};
}

void expect_format(const io::JsonObject& json) {
    if (!json.is_text("format") || json.text("format") != "voxtone-batch-job")
        json.fail("format", "this is not the state of a job of a batch");
    if (json.integer("version", 0, 1000000) != 1)
        json.fail("version", "another version of the program made it; this one reads version 1");
    json.allow_only({"format", "version", "name", "number", "state", "command", "program", "folder_is_ours", "attempts",
                     "attempts_that_got_on", "threads", "expected_cpu_seconds", "runner", "exit_code", "message",
                     "finished", "inputs", "figures", "after"});
}

}  // namespace

std::vector<std::string> lost_colours(const StackFigures& figures) {
    std::vector<std::string> lost;
    for (const std::string& warning : figures.warnings)
        if (message_name(warning) == "lost-colour") lost.push_back(warning);
    return lost;
}

void read_shared_figures(const io::JsonObject& json, StackFigures& figures) {
    const std::vector<double> size = json.numbers("size_mm", 3, 0, 1e9);
    figures.size_mm = {size[0], size[1], size[2]};
    figures.layers = json.integer("layers", 0, any_count);
    figures.voxels = json.integer("voxels", 0, any_count);
    figures.warnings = json.texts("warnings");
    figures.seconds = json.number("seconds", 0, 1e12);
    figures.peak_memory_bytes = json.integer("peak_memory_bytes", 0, any_count);
    figures.output_bytes = json.integer("output_bytes", 0, any_count);
}

std::string state_json(const JobState& state) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-batch-job").add("version", 1);
    json.line().add("name", state.name).add("number", state.number).add("state", name_of(state.phase));
    json.line().add("command", state.command);
    json.line().add("program", state.program).add("folder_is_ours", state.folder_is_ours);
    json.add("attempts", state.attempts);
    if (state.attempts_that_got_on > 0) json.add("attempts_that_got_on", state.attempts_that_got_on);
    if (state.threads > 0) json.add("threads", state.threads);
    if (state.expected_cpu_s > 0) json.add("expected_cpu_seconds", state.expected_cpu_s);
    if (state.runner) write_runner(json, *state.runner);
    json.line().add("exit_code", state.exit_code);
    if (!state.message.empty()) json.line().add("message", state.message);
    if (!state.finished.empty()) json.line().add("finished", state.finished);
    write_inputs(json, state);
    if (state.figures) write_figures(json, *state.figures);
    if (state.after) {
        json.line().key("after").begin_object().add("over", state.after->over);
        json.add("exit_code", state.after->exit_code).end_object();
    }
    return json.end_object().text() + "\n";
}

JobState read_state(const std::filesystem::path& file) {
    const io::JsonObject json = io::JsonObject::read(file);
    expect_format(json);
    JobState state;
    state.name = json.text("name");
    state.number = json.integer("number", 0, any_count);
    const auto phase = value_of<JobPhase>(json.text("state"));
    if (!phase) json.fail("state", "is none of queued, running, done, failed");
    state.phase = *phase;
    state.command = json.texts("command");
    state.program = json.text("program");
    state.folder_is_ours = json.boolean("folder_is_ours");
    state.attempts = static_cast<int>(json.integer("attempts", 0, 1000000));
    if (json.has("attempts_that_got_on"))
        state.attempts_that_got_on = static_cast<int>(json.integer("attempts_that_got_on", 0, 1000000));
    if (json.has("threads")) state.threads = static_cast<int>(json.integer("threads", 0, 1000000));
    if (json.has("expected_cpu_seconds")) state.expected_cpu_s = json.number("expected_cpu_seconds", 0, 1e12);
    if (json.has("runner")) state.runner = read_runner(json.object("runner"));
    state.exit_code = static_cast<int>(json.number("exit_code", -1, 255));
    if (json.has("message")) state.message = json.text("message");
    if (json.has("finished")) state.finished = json.text("finished");
    for (const io::JsonObject& input : json.objects("inputs")) state.inputs.push_back(read_input(input));
    if (json.has("figures")) state.figures = read_figures(json.object("figures"));
    if (json.has("after")) {
        const io::JsonObject after = json.object("after");
        state.after = AfterState{after.boolean("over"), static_cast<int>(after.number("exit_code", -1, 255))};
    }
    return state;
}

bool lives_here(const JobRunner& runner) {
    return runner.host == io::host_name() && runner.start != 0 && io::start_of_process(runner.pid) == runner.start;
}

std::optional<double> seconds_of(const std::string& utc) {
    std::tm time{};
    const char* const end = strptime(utc.c_str(), "%Y-%m-%dT%H:%M:%SZ", &time);
    if (!end || *end != '\0') return std::nullopt;
    return static_cast<double>(timegm(&time));
}

std::string utc_now() { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))); }

}  // namespace voxtone::farm

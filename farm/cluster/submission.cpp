// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/cluster/submission.h"

#include <algorithm>
#include <limits>
#include <system_error>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "io/files/json_object.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "slicer/options/job_file.h"

namespace voxtone::farm {

namespace {

namespace fs = std::filesystem;

constexpr const char* submission_name = "submission.json";
constexpr const char* closing_name = ".last.json";  // no job's name begins with a dot
constexpr std::uint64_t latest_ns = std::numeric_limits<std::int64_t>::max();

void make_folder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw FileError(fmt::format("{}: cannot be made ({})", folder.string(), error.message()));
}

SubmittedStage read_stage(const io::JsonObject& json) {
    SubmittedStage stage;
    const auto known = value_of<TaskStage>(json.text("stage"));
    if (!known) json.fail("stage", "names no stage of a job");
    stage.stage = *known;
    stage.arguments = json.texts("words");
    stage.tasks = static_cast<int>(json.integer("tasks", 1, 1'000'000));
    stage.numbers = json.texts("numbers");
    if (json.has("memory_bytes"))
        stage.memory_bytes = json.integer("memory_bytes", 0, std::numeric_limits<std::uint64_t>::max());
    if (json.has("starved")) stage.is_starved = json.boolean("starved");
    if (json.has("raised")) stage.is_raised = json.boolean("raised");
    return stage;
}

Submission read_submission(const fs::path& file) {
    const io::JsonObject json = io::JsonObject::read(file);
    if (json.text("format") != "voxtone-submission") json.fail("format", "is not voxtone-submission");
    (void)json.integer("version", 1, 1);
    Submission submission;
    submission.job = json.text("job");
    submission.since = json.text("since");
    submission.began_ns = static_cast<std::int64_t>(json.integer("began_ns", 0, latest_ns));
    submission.complete = json.boolean("complete");
    for (const io::JsonObject& stage : json.objects("stages")) submission.stages.push_back(read_stage(stage));
    if (json.has("jobs")) submission.jobs = json.integer("jobs", 0, std::numeric_limits<std::uint32_t>::max());
    return submission;
}

}  // namespace

std::vector<std::string> Submission::numbers() const {
    std::vector<std::string> all;
    for (const SubmittedStage& stage : stages) all.insert(all.end(), stage.numbers.begin(), stage.numbers.end());
    return all;
}

std::vector<std::string> Submission::ends() const {
    std::vector<std::string> all;
    for (const SubmittedStage& stage : stages)
        if (stage.numbers.size() > 1 || &stage == &stages.back())
            all.insert(all.end(), stage.numbers.begin(), stage.numbers.end());
    return all;
}

std::string Submission::text() const {
    if (numbers().empty()) return "by Open Job Description";
    std::string text;
    for (const SubmittedStage& stage : stages)
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name_of(stage.stage), fmt::join(stage.numbers, " "));
    return fmt::format("in Slurm ({})", text);
}

fs::path SubmissionFolder::script(const std::string& job, TaskStage stage) const {
    return of(job) / fmt::format("{}.sh", name_of(stage));
}

fs::path SubmissionFolder::task_log(const std::string& job, TaskStage stage, int task) const {
    return of(job) / fmt::format("{}-{}.log", name_of(stage), task);
}

std::optional<Submission> SubmissionFolder::read(const std::string& job) const {
    try {
        Submission submission = read_submission(of(job) / submission_name);
        if (submission.job == job) return submission;
    } catch (const Error&) {
        // It is as if nothing had been submitted: tasks may run twice.
    }
    return std::nullopt;
}

std::vector<Submission> SubmissionFolder::all() const {
    std::vector<Submission> all;
    std::error_code none;
    for (const fs::directory_entry& entry : fs::directory_iterator(batch_ / "slurm", none))
        if (auto submission = read(entry.path().filename().string())) all.push_back(std::move(*submission));
    std::sort(all.begin(), all.end(), [](const Submission& a, const Submission& b) { return a.job < b.job; });
    return all;
}

void SubmissionFolder::write(const Submission& submission) const {
    make_folder(of(submission.job));
    io::write_whole_file(of(submission.job) / submission_name, submission_json(submission));
}

void SubmissionFolder::write_job(const PlannedJob& job) const {
    make_folder(of(job.name));
    io::write_whole_file(job_file(job.name), slicer::job_json(job.options));
}

void SubmissionFolder::write_script(const fs::path& script, const std::string& text) const {
    make_folder(script.parent_path());
    io::write_whole_file(script, text);
}

std::optional<Closing> SubmissionFolder::read_closing() const {
    try {
        const io::JsonObject json = io::JsonObject::read(batch_ / "slurm" / closing_name);
        return Closing{json.text("number"), static_cast<std::int64_t>(json.integer("since_ns", 0, latest_ns))};
    } catch (const Error&) {
        return std::nullopt;  // then one more is submitted, which harms nothing
    }
}

void SubmissionFolder::write_closing(const Closing& closing) const {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-closing").add("version", 1);
    json.add("number", closing.number).add("since_ns", closing.since_ns).end_object();
    make_folder(batch_ / "slurm");
    io::write_whole_file(batch_ / "slurm" / closing_name, json.text() + "\n");
}

std::string submission_json(const Submission& submission) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-submission").add("version", 1).line().add("job", submission.job);
    json.add("since", submission.since).add("began_ns", submission.began_ns).add("complete", submission.complete);
    if (submission.jobs > 0) json.add("jobs", submission.jobs);
    json.line().key("stages").begin_list();
    for (const SubmittedStage& stage : submission.stages) {
        json.line().begin_object().add("stage", name_of(stage.stage)).add("tasks", stage.tasks);
        json.add("numbers", stage.numbers).add("words", stage.arguments);
        if (stage.memory_bytes > 0) json.add("memory_bytes", stage.memory_bytes);
        if (stage.is_starved) json.add("starved", true);
        if (stage.is_raised) json.add("raised", true);
        json.end_object();
    }
    return json.end_list().end_object().text() + "\n";
}

}  // namespace voxtone::farm

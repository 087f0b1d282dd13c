// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/plan.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <map>
#include <set>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/counted.h"
#include "base/error.h"
#include "io/files/json_object.h"
#include "io/files/zip_reader.h"
#include "slicer/options/command_words.h"
#include "slicer/options/job_file.h"
#include "slicer/options/label_template.h"
#include "slicer/options/option_table.h"
#include "slicer/options/option_values.h"
#include "slicer/part/opened_job.h"
#include "slicer/plans/job_names.h"
#include "slicer/plans/tray_plan.h"

namespace voxtone::farm {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view name_key = "name";

/// Its lines are counted from the beginning of the plan, so that faults are told where they are.
io::JsonObject object_of(const PlanRow& row, const std::string& source, bool in_place) {
    const std::string lines_before(in_place && row.line > 0 ? row.line - 1 : 0, '\n');
    return io::JsonObject::parse(lines_before + row.json, source);
}

/// With "copies", which makes a table one of a tray: who misspells it is told.
std::vector<std::string> keys_of_job() {
    std::vector<std::string> known{std::string(name_key), "format", "version", "inputs", "copies"};
    for (std::string& key : slicer::option_keys()) known.push_back(std::move(key));
    return known;
}

/// Texts of the user's own. Throws InputError for keys that are none.
slicer::TemplateValues own_values(const io::JsonObject& object) {
    slicer::refuse_copies(object);
    return slicer::values_of_row(object, keys_of_job());
}

/// What only the batch may say of its jobs.
void refuse_what_batches_decide(const io::JsonObject& object) {
    if (object.has("out") && !object.any_text("out").empty())
        object.fail("out",
                    "each job of a batch has a folder of its own below that of the batch: leave it out, or "
                    "give the job a \"name\"");
    if (object.has("for-printer") && !object.any_text("for-printer").empty())
        object.fail("for-printer",
                    "each job of a batch has what the printer takes in a folder printer of its own: leave it out");
    for (const char* const key : {"overwrite", "resume"})
        if (object.has(key) && object.any_text(key) != "false")
            object.fail(key,
                        "a batch finds out by itself which jobs are to go on and which to be made again: leave "
                        "it out");
}

/// "plan.csv: line 4"; empty where the plan is no file.
std::string place_of(const PlanRow& row, const std::string& source) {
    return row.line > 0 ? fmt::format("{}: line {}", source, row.line) : std::string();
}

/// The job of a row but for its name, which is what the row or the model is called.
PlannedJob job_of(const PlanRow& row, const std::string& source, const slicer::SliceOptions& preset, bool in_place) {
    const io::JsonObject object = object_of(row, source, in_place);
    const slicer::TemplateValues own = own_values(object);
    refuse_what_batches_decide(object);
    PlannedJob job;
    job.options = preset;
    std::vector<std::string> said = slicer::take_options(object, row.folder, job.options);
    const slicer::SliceOptions defaults_of_slice;  // who says those says nothing, as in a job file
    std::erase_if(said, [&](const std::string& key) {
        const slicer::OptionSpec& spec = *slicer::find_option(key);
        return spec.get(job.options) == spec.get(defaults_of_slice);
    });
    for (std::string& label : job.options.labels) label = slicer::with_values(label, own);
    job.options = slicer::with_absolute_paths(std::move(job.options));
    slicer::drop_idle(job.options, said);
    job.name = object.has(name_key) ? object.any_text(name_key)
                                    : slicer::name_after(fs::path(job.options.model).stem().string());
    job.place = place_of(row, source);
    return job;
}

slicer::SliceOptions preset_of(const PlanOptions& options) {
    slicer::SliceOptions preset = options.begin_with.value_or(slicer::SliceOptions());
    if (!options.preset.empty()) slicer::read_job(options.preset, preset);
    preset.model.clear();
    preset.out.clear();
    preset.overwrite = preset.resume = false;
    if (!preset.for_printer.empty())
        throw InputError(
            "for-printer: is one place for one print; each job of a batch has a folder printer of its own");
    preset.recorded_inputs.clear();
    return preset;
}

void expect_file(const std::string& file, const char* what) {
    if (file.empty()) return;
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    if (!fs::exists(status)) throw FileError(fmt::format("{} {} is not there; check the path", what, file));
    if (fs::is_directory(status)) throw InputError(fmt::format("{}: a folder, not a {}; name the file", file, what));
    if (access(file.c_str(), R_OK) != 0)
        throw FileError(fmt::format("{} {} cannot be read ({})", what, file, std::strerror(errno)));
}

void expect_component(const slicer::TrayComponent& component) {
    if (component.kind == slicer::ComponentKind::body) return expect_file(component.path, "model");
    if (component.kind == slicer::ComponentKind::gcvf) return expect_file(component.path, "gcvf");
    if (component.kind == slicer::ComponentKind::stack)
        expect_file((std::filesystem::path(component.path) / io::manifest_name).string(), "manifest");
}

void expect_sound_parts(const PlannedJob& job) {
    for (const slicer::TrayPart& part : slicer::read_tray_plan(job.options.model, job.options).parts) {
        if (part.component) {
            expect_component(*part.component);
            continue;
        }
        expect_file(io::path_in_zip(part.options.model).file.string(), "model");
        slicer::SliceOptions options = part.options;
        options.out = job.options.out;
        (void)slicer::open_job(options);
    }
}

/// All that can be known to be wrong before the model is read.
void expect_sound(const PlannedJob& job) {
    if (job.options.model.empty()) throw InputError("names no model; give it one under \"model\"");
    if (const std::string fault = slicer::name_fault(job.name); !fault.empty())
        throw InputError(
            fmt::format("the job's name '{}' {}; give it another under \"name\" or with --name", job.name, fault));
    expect_file(io::path_in_zip(job.options.model).file.string(), "model");
    expect_file(job.options.texture, "texture");
    const slicer::OpenedJob opened = slicer::open_job(job.options);  // its folder is looked at when its turn comes
    if (opened.options.kind == slicer::ModelKind::tray_plan) expect_sound_parts(job);
}

/// Gives the job its name and place in the batch.
void settle(PlannedJob& job, const slicer::NameTemplate& names, std::size_t n, const fs::path& out) {
    job.name = names.fill(job.name, n, job.options);
    job.out = (fs::absolute(out) / job.name).lexically_normal();
    job.options.out = job.out.string();
    job.command = slicer::command_words(job.options);
}

/// The place once, before what is wrong there.
std::string fault_text(const std::string& place, const std::string& source, const std::string& what) {
    if (place.empty() || what.starts_with(place)) return what;
    return place + ": " + (what.starts_with(source + ": ") ? what.substr(source.size() + 2) : what);
}

/// Adds the row's job, or what is wrong with it.
void take_row(const PlanRow& row, std::size_t n, const PlanRows& rows, const slicer::SliceOptions& preset,
              const PlanOptions& options, std::vector<PlannedJob>& jobs, std::vector<std::string>& faults) {
    const std::string place = place_of(row, rows.source);
    try {
        PlannedJob job = job_of(row, rows.source, preset, false);
        settle(job, slicer::NameTemplate(options.name), n, options.out);
        expect_sound(job);
        jobs.push_back(std::move(job));
    } catch (const Error& error) {
        std::string what = error.what();
        try {  // the same fault, told with its line
            (void)job_of(row, rows.source, preset, true);
        } catch (const Error& in_place) {
            what = in_place.what();
        }
        faults.push_back(fault_text(place, rows.source, what));
    }
}

void find_doubles(const std::vector<PlannedJob>& jobs, std::vector<std::string>& faults) {
    std::map<std::string, const PlannedJob*> first;
    for (const PlannedJob& job : jobs) {
        const auto [found, is_new] = first.emplace(job.name, &job);
        if (is_new) continue;
        const PlannedJob& other = *found->second;
        const bool in_file = !job.place.empty();
        faults.push_back(fmt::format(
            "{}: is called '{}', as {} is; give one of them another \"name\", or count them: --name "
            "'{{name}}-{{n:03}}'",
            in_file ? job.place : job.options.model, job.name, in_file ? other.place : other.options.model));
    }
}

/// A word that is misspelt is one of them.
void note_own_words(const PlanRows& rows, Progress& progress) {
    const std::vector<std::string> known = keys_of_job();
    std::set<std::string> own;
    for (const PlanRow& row : rows.rows)
        own.merge([&] {
            const std::vector<std::string> words = slicer::own_words(object_of(row, rows.source, false), known);
            return std::set<std::string>(words.begin(), words.end());
        }());
    if (!own.empty()) progress.note(slicer::own_words_note(own));
}

[[noreturn]] void refuse(const std::string& source, const std::vector<std::string>& faults) {
    if (faults.size() == 1) throw InputError(faults[0] + "; no job was started");
    throw InputError(fmt::format("{}: {}; no job was started, mend them and run it again:\n{}", source,
                                 counted(faults.size(), "fault"), fmt::join(faults, "\n")));
}

}  // namespace

std::vector<PlannedJob> plan_jobs(const PlanRows& rows, const PlanOptions& options, Progress* progress) {
    (void)slicer::NameTemplate(options.name);
    const slicer::SliceOptions preset = preset_of(options);
    std::vector<PlannedJob> jobs;
    std::vector<std::string> faults = rows.faults;
    std::size_t n = 0;
    for (const PlanRow& row : rows.rows) {
        if (progress) progress->check_cancelled();
        take_row(row, ++n, rows, preset, options, jobs, faults);
    }
    find_doubles(jobs, faults);
    if (!faults.empty()) refuse(rows.source, faults);
    if (progress) note_own_words(rows, *progress);
    return jobs;
}

std::vector<PlannedJob> read_plan(const PlanOptions& options, Progress* progress) {
    return plan_jobs(read_plan_rows(options.plan), options, progress);
}

}  // namespace voxtone::farm

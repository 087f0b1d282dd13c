// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/plan_rows.h"

#include <glob.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "base/error.h"
#include "io/files/csv_table.h"
#include "io/files/read_bytes.h"
#include "io/models/foreign_kind.h"
#include "io/models/model_reader.h"
#include "slicer/plans/plan_table.h"
#include "slicer/plans/tray_plan.h"

namespace voxtone::farm {

namespace {

namespace fs = std::filesystem;

std::string text_of_plan(const fs::path& file) {
    constexpr std::uint64_t most_bytes = std::uint64_t{64} << 20;
    return io::read_text(file, most_bytes);
}

void read_table(const std::string& text, const fs::path& folder, PlanRows& plan) {
    slicer::PlanTable table = slicer::plan_table(text, slicer::keys_of_part());
    for (const std::string& fault : table.faults) plan.faults.push_back(plan.source + ": " + fault);
    for (slicer::PlanTableRow& row : table.rows) plan.rows.push_back({row.line, std::move(row.json), folder});
}

void read_list(std::string_view text, const fs::path& folder, PlanRows& plan) {
    for (std::size_t line = 1; !text.empty(); ++line) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view row = text.substr(0, end);
        const std::size_t first = row.find_first_not_of(" \t\r");
        if (first != std::string_view::npos && row[first] != '#') plan.rows.push_back({line, std::string(row), folder});
        text.remove_prefix(std::min(end + 1, text.size()));
    }
}

bool is_pattern(const std::string& word) { return word.find_first_of("*?[") != std::string::npos; }

bool ends_as(const fs::path& file, std::string_view extension) { return io::extension_of(file) == extension; }

/// By name, as the shell would have it.
std::vector<fs::path> matches_of(const std::string& pattern) {
    glob_t found{};
    std::vector<fs::path> files;
    if (glob(pattern.c_str(), 0, nullptr, &found) == 0) files.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
    globfree(&found);
    return files;
}

void add_models(const std::string& word, PlanRows& plan) {
    if (fs::exists(word) || !is_pattern(word)) {
        plan.rows.push_back(row_of(word));
        return;
    }
    const std::vector<fs::path> files = matches_of(word);
    if (files.empty()) plan.faults.push_back(fmt::format("{}: no file matches; check the path", word));
    for (const fs::path& file : files) plan.rows.push_back(row_of(file));
}

/// Whether the word names a file that lists jobs, and no model.
bool is_list(const std::string& word) {
    constexpr std::array<std::string_view, 7> lists{"jsonl", "ndjson", "json", "txt", "csv", "tsv", "tab"};
    return std::find(lists.begin(), lists.end(), io::extension_of(word)) != lists.end();
}

/// What else lies in a folder, of the first file that is known; empty: nothing of the kind.
std::string foreign_in(const fs::path& folder) {
    std::error_code error;
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
        if (!entry.path().filename().string().starts_with('.') && !io::is_picture_name(entry.path()))
            files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files)
        if (const std::string why = io::foreign_kind(file); !why.empty()) return ". " + why;
    return {};
}

/// A file of the options of one job, as `slice` writes it over several lines, in one line, which is that of a list;
/// empty: it is no such file.
std::string job_line(const std::string& word) {
    if (!ends_as(word, "json")) return {};
    try {
        const io::JsonObject object = io::JsonObject::read(word);
        if (!object.has("format") || object.any_text("format") != "voxtone-job") return {};
    } catch (const Error&) {
        return {};  // as a list it says what is wrong
    }
    std::string line = text_of_plan(word);
    std::ranges::replace_if(
        line, [](char c) { return c == '\n' || c == '\r'; }, ' ');
    return line;
}

PlanRows read_one(const std::string& word) {
    PlanRows plan{word, {}, {}};
    const fs::path folder = fs::path(word).parent_path();
    if (fs::is_directory(word)) {
        for (const fs::path& model : models_in(word)) plan.rows.push_back(row_of(model));
        if (plan.rows.empty())
            plan.faults.push_back(fmt::format("{}: holds no model ({}); for pictures give a pattern, '{}/*.png'{}",
                                              word, io::model_name_endings, word, foreign_in(word)));
    } else if (slicer::is_tray_plan(word)) {
        plan.rows.push_back(row_of(word));
    } else if (fs::exists(word) && io::is_table_file(word, "model")) {
        read_table(text_of_plan(word), folder, plan);
    } else if (const std::string line = job_line(word); !line.empty()) {
        read_list(line, folder, plan);
    } else if (is_list(word)) {
        read_list(text_of_plan(word), folder, plan);
    } else {
        add_models(word, plan);
    }
    return plan;
}

}  // namespace

std::vector<fs::path> models_in(const fs::path& folder) {
    std::error_code error;
    std::vector<fs::path> models;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
        const fs::path& file = entry.path();
        if (!file.filename().string().starts_with('.') && io::is_model_name(file) && entry.is_regular_file(error))
            models.push_back(file);
    }
    if (error) throw FileError(fmt::format("{}: cannot be looked into ({})", folder.string(), error.message()));
    std::sort(models.begin(), models.end());
    return models;
}

bool is_plan(const std::string& word) {
    std::error_code none;
    return is_list(word) || fs::is_directory(word, none) || (is_pattern(word) && !fs::exists(word, none));
}

PlanRow row_of(const fs::path& model) {
    io::JsonWriter json;
    json.begin_object().add("model", model.string()).end_object();
    return {0, json.text(), {}};
}

PlanRows read_plan_rows(std::span<const std::string> plan) {
    if (plan.empty()) throw UsageError("name a plan: a job list, a table, a folder of models or a pattern of files");
    PlanRows all = plan.size() == 1 ? read_one(plan[0]) : PlanRows{"the plan", {}, {}};
    if (plan.size() > 1)
        for (const std::string& word : plan) {
            if ((is_list(word) && !slicer::is_tray_plan(word)) || fs::is_directory(word))
                throw UsageError(fmt::format("{}: a batch has one plan; several words are models each", word));
            add_models(word, all);
        }
    if (all.rows.empty() && all.faults.empty()) all.faults.push_back(all.source + ": lists no job");
    return all;
}

}  // namespace voxtone::farm

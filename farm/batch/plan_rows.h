// SPDX-License-Identifier: GPL-3.0-or-later
//
// The jobs of a plan as its user wrote them, from any kind of plan:
//   a job list, one JSON object a line:   {"model": "spot.obj", "size": "40mm", "name": "small"}
//   a table (.csv, .tsv, .txt of a spreadsheet) whose header names options: model,size,name
//   a folder, or files and patterns of files ("parts/*.glb"): one job a model.
// Blank lines and lines that begin with '#' are skipped.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace voxtone::farm {

struct PlanRow {
    std::size_t line = 0;          ///< in the plan; 0: it is no file
    std::string json;              ///< one object: options by their keys in a job file, and perhaps a name
    std::filesystem::path folder;  ///< from where its paths are seen
};

struct PlanRows {
    std::string source;  ///< name of the plan, for messages
    std::vector<PlanRow> rows;
    std::vector<std::string> faults;  ///< one sentence each, beginning with the place
};

/// `plan`: one file or folder, or any number of models. Throws UsageError, FileError, InputError for what is no plan at
/// all.
[[nodiscard]] PlanRows read_plan_rows(std::span<const std::string> plan);

/// Whether this word, given alone, is a plan of many jobs, and no model.
[[nodiscard]] bool is_plan(const std::string& word);

/// The models in a folder, by name; not those in folders below it, nor hidden ones. Throws FileError.
[[nodiscard]] std::vector<std::filesystem::path> models_in(const std::filesystem::path& folder);

/// The row of a model without options of its own.
[[nodiscard]] PlanRow row_of(const std::filesystem::path& model);

}  // namespace voxtone::farm

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The options of a slice job on a command line (slicer/options/option_table.h), for every verb that takes such a job.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "cli/program/verb.h"
#include "slicer/options/slice_options.h"
#include "slicer/plans/tray_plan.h"

namespace voxtone::cli {

/// What the command line said. Stays where it was made: the table of options points to it.
struct JobArguments {
    JobArguments() = default;
    JobArguments(const JobArguments&) = delete;
    JobArguments& operator=(const JobArguments&) = delete;

    std::map<std::string, std::string> values;  ///< by key
    std::map<std::string, std::vector<std::string>> texts;
    std::map<std::string, bool> flags;
    std::set<std::string> keys;  ///< that the verb takes
    std::shared_ptr<const Verb::Said> said;
    std::string job;          ///< file
    bool takes_many = false;  ///< models: set before the options are added
    std::vector<std::string> models;
    bool dump_default = false;
    int copies = 1;  ///< of each model
};

/// All of the table, and --job. `without`: keys of options that this verb does not take.
void add_job_options(Verb& command, JobArguments& arguments, const std::vector<std::string>& without = {});

/// Those of these keys alone, without --job.
void add_some_job_options(Verb& command, JobArguments& arguments, const std::vector<std::string>& keys);

/// --dump-default, which the verb looks at before it runs.
void add_dump_default(Verb& command, JobArguments& arguments);

/// Those of the job file, if one was named, with the command line's on top. Throws what reading the file throws, and
/// UsageError.
[[nodiscard]] slicer::SliceOptions options_of(const JobArguments& arguments);

/// The models, where several were named, or copies of one; empty: one, or a plan. Throws UsageError for a plan beside
/// others, or copies of one.
[[nodiscard]] slicer::TrayModels many_models(const JobArguments& arguments, const slicer::SliceOptions& options);

}  // namespace voxtone::cli

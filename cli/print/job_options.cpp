// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/print/job_options.h"

#include <algorithm>
#include <vector>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "slicer/options/job_file.h"
#include "slicer/options/option_scope.h"

namespace voxtone::cli {

void add_job_options(CLI::App& command, JobArguments& arguments) {
    const slicer::SliceOptions defaults;
    for (const slicer::OptionSpec& spec : slicer::slice_option_table()) {
        CLI::Option* option;
        if (spec.kind == slicer::OptionSpec::Kind::flag) {
            arguments.flags[spec.key] = spec.get(defaults) == "true";
            option =
                command.add_flag(fmt::format("--{0},!--no-{0}", spec.option), arguments.flags[spec.key], spec.help);
            option->default_str(spec.get(defaults));
        } else {
            const std::string names = spec.key == "model" ? "mesh,--mesh"
                                      : spec.key == "out" ? "-o,--out"
                                                          : "--" + spec.option;
            option = command.add_option(
                names, arguments.values[spec.key],
                spec.choices.empty() ? spec.help : fmt::format("{} [{}]", spec.help, fmt::join(spec.choices, "|")));
            option->type_name(spec.metavar);
            if (const std::string text = spec.get(defaults); !text.empty()) option->default_str(text);
        }
        // Without a value: as the scheduler says.
        if (spec.key == "shard") option->expected(0, 1)->default_str("");
        option->group(spec.group);
        arguments.options[spec.key] = option;
    }
    command
        .add_option("--job", arguments.job,
                    "read options from this job file; the command line wins. Paths in it are seen from its folder")
        ->type_name("FILE")
        ->group("Run");
}

slicer::SliceOptions options_of(const JobArguments& arguments) {
    slicer::SliceOptions options;
    std::vector<std::string> named;
    if (!arguments.job.empty()) slicer::read_job(arguments.job, options);
    for (const slicer::OptionSpec& spec : slicer::slice_option_table()) {
        if (arguments.options.at(spec.key)->count() == 0) continue;
        const bool is_bare = spec.key == "shard" && arguments.values.at(spec.key).empty();
        spec.set(options, spec.kind == slicer::OptionSpec::Kind::flag
                              ? (arguments.flags.at(spec.key) ? "true" : "false")
                              : (is_bare ? "auto" : arguments.values.at(spec.key)));
        named.push_back(spec.key);
    }
    if (std::any_of(named.begin(), named.end(), slicer::decides_scope)) options.named.clear();
    options.named.insert(options.named.end(), named.begin(), named.end());
    return options;
}

}  // namespace voxtone::cli

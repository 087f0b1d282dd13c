// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "voxtone/cli/commands.h"
#include "voxtone/cli/console.h"
#include "voxtone/cli/help.h"
#include "voxtone/cli/outcome.h"
#include "voxtone/slicer/job/slice_job.h"
#include "voxtone/slicer/options/job_file.h"
#include "voxtone/slicer/options/option_scope.h"
#include "voxtone/slicer/options/slice_options.h"

namespace voxtone::cli {

namespace {

struct SliceArguments {
    std::map<std::string, std::string> values;  ///< what the command line said, by key
    std::map<std::string, bool> flags;
    std::map<std::string, CLI::Option*> options;
    std::string job;
    bool dump_default = false;
    ConsoleOptions console;
};

void add_options(CLI::App& command, SliceArguments& arguments) {
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
        option->group(spec.group);
        arguments.options[spec.key] = option;
    }
    command
        .add_option("--job", arguments.job,
                    "read options from this job file; the command line wins. Paths in it are seen from its folder")
        ->type_name("FILE")
        ->group("Run");
    command
        .add_flag("--dump-default", arguments.dump_default,
                  "print a complete job file, with the options given and every default, and stop")
        ->group("Run");
    add_console_options(command, arguments.console);
}

slicer::SliceOptions options_of(const SliceArguments& arguments) {
    slicer::SliceOptions options;
    std::vector<std::string> named;
    if (!arguments.job.empty()) slicer::read_job(arguments.job, options);
    for (const slicer::OptionSpec& spec : slicer::slice_option_table()) {
        if (arguments.options.at(spec.key)->count() == 0) continue;
        spec.set(options, spec.kind == slicer::OptionSpec::Kind::flag
                              ? (arguments.flags.at(spec.key) ? "true" : "false")
                              : arguments.values.at(spec.key));
        named.push_back(spec.key);
    }
    if (std::any_of(named.begin(), named.end(), slicer::decides_scope)) options.named.clear();
    options.named.insert(options.named.end(), named.begin(), named.end());
    return options;
}

int run(const SliceArguments& arguments) {
    const slicer::SliceOptions options = options_of(arguments);
    if (arguments.dump_default) {
        print_out(slicer::job_json(options));
        return 0;
    }
    return run_on_console(arguments.console, [&](Progress& progress) {
        slicer::SliceResult result = slicer::run_slice_job(options, progress);
        return JobResult{std::move(result.json), std::move(result.summary), result.exit_code};
    });
}

}  // namespace

Command add_slice_command(CLI::App& program) {
    auto arguments = std::make_shared<SliceArguments>();
    CLI::App* command =
        program.add_subcommand("slice", "Slice a textured mesh or a picture into a printable layer stack");
    add_options(*command, *arguments);
    add_example(*command, "cow.obj --size 60mm -o out/cow");
    return [arguments] { return run(*arguments); };
}

}  // namespace voxtone::cli

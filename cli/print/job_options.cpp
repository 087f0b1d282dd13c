// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/print/job_options.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "base/error.h"
#include "io/layers/layer_format.h"
#include "slicer/options/job_file.h"
#include "slicer/options/option_scope.h"
#include "slicer/options/option_table.h"
#include "slicer/options/option_values.h"
#include "slicer/tray/tray_job.h"
#include "slicer/tray/tray_shard.h"

namespace voxtone::cli {

namespace {

using slicer::OptionSpec;

/// "model,--model", "-o,--out".
std::string names_of_option(const OptionSpec& spec) {
    std::string names = "--" + spec.option;
    if (!spec.letter.empty()) names = "-" + spec.letter + "," + names;
    return spec.positional ? spec.option + "," + names : names;
}

CLI::Option* add_flag(CLI::App& command, const OptionSpec& spec, bool usual, bool& value) {
    value = usual;
    return command.add_flag(fmt::format("--{0},!--no-{0}", spec.option), value, spec.help)
        ->default_str(usual ? "true" : "false");
}

CLI::Option* add_value(CLI::App& command, const OptionSpec& spec, const std::string& usual, std::string& value) {
    const std::string help =
        spec.choices.empty() ? spec.help : fmt::format("{} [{}]", spec.help, fmt::join(spec.choices, "|"));
    CLI::Option* const option = command.add_option(names_of_option(spec), value, help)->type_name(spec.metavar);
    if (!usual.empty()) option->default_str(usual);
    if (!spec.bare.empty()) option->expected(0, 1)->default_str("");
    return option;
}

/// Said once for each text.
CLI::Option* add_texts(CLI::App& command, const OptionSpec& spec, std::vector<std::string>& texts) {
    return command.add_option(names_of_option(spec), texts, spec.help)
        ->type_name(spec.metavar)
        ->allow_extra_args(false);
}

/// An option of an earlier name: taken, and told of nowhere.
void add_former(CLI::App& command, const OptionSpec& spec, JobArguments& arguments) {
    if (spec.former_option.empty()) return;
    const std::string name = "--" + spec.former_option;
    const auto take = [&arguments, key = spec.key](const std::vector<std::string>& values) {
        (key == "model" && arguments.takes_many ? arguments.models : arguments.former_values[key]) = values;
    };
    CLI::Option* const former = command.add_option_function<std::vector<std::string>>(name, take)->group("");
    if (spec.key != "model" || !arguments.takes_many) former->expected(1);
    arguments.former_options[spec.key] = former;
}

void add_option(CLI::App& command, const OptionSpec& spec, JobArguments& arguments) {
    const std::string usual = spec.get(slicer::SliceOptions{});
    CLI::Option* const option =
        spec.key == "model" && arguments.takes_many
            ? command.add_option(names_of_option(spec), arguments.models, spec.help)->type_name(spec.metavar)
        : spec.kind() == OptionSpec::Kind::flag  ? add_flag(command, spec, usual == "true", arguments.flags[spec.key])
        : spec.kind() == OptionSpec::Kind::texts ? add_texts(command, spec, arguments.texts[spec.key])
                                                 : add_value(command, spec, usual, arguments.values[spec.key]);
    option->group(spec.group);
    arguments.options[spec.key] = option;
    add_former(command, spec, arguments);
}

/// What the command line says of an option; nothing: it does not name it.
std::optional<std::string> said(const JobArguments& arguments, const OptionSpec& spec, slicer::SliceOptions& options) {
    const auto option = arguments.options.find(spec.key);
    const bool is_said = option != arguments.options.end() && option->second->count() > 0;
    const auto former = arguments.former_options.find(spec.key);
    if (former != arguments.former_options.end() && former->second->count() > 0) {
        if (is_said)
            throw UsageError(fmt::format("--{0} is what --{1} was called earlier, and both are given: leave --{0} out",
                                         spec.former_option, spec.option));
        options.notes.push_back(fmt::format("--{0} is called --{1} now, which means the same; it was taken",
                                            spec.former_option, spec.option));
    } else if (!is_said) {
        return std::nullopt;
    }
    if (spec.kind() == OptionSpec::Kind::flag) return arguments.flags.at(spec.key) ? "true" : "false";
    if (spec.key == "model" && arguments.takes_many) return arguments.models.front();
    if (!is_said) return arguments.former_values.at(spec.key).back();
    if (spec.kind() == OptionSpec::Kind::texts) return fmt::format("{}", fmt::join(arguments.texts.at(spec.key), "\n"));
    const std::string& value = arguments.values.at(spec.key);
    return value.empty() && !spec.bare.empty() ? spec.bare : value;
}

/// `-o x.gcvf` is that one file; all else that a job leaves (report, figures) lies in the folder x beside it.
void take_one_file(slicer::SliceOptions& options) {
    std::filesystem::path folder = options.out;
    if (folder.extension() != ".gcvf") return;
    if (!options.for_printer.empty())
        throw UsageError(
            fmt::format("-o {0} is what goes to the printer, and --for-printer {1} names another place for it: name a "
                        "folder by -o, or leave --for-printer out",
                        options.out, options.for_printer));
    options.for_printer = options.out;
    options.out = folder.replace_extension().string();
}

/// What is to be handed over is made.
void add_format_for_printer(slicer::SliceOptions& options) {
    const std::string gcvf(name_of(io::LayerFormat::gcvf));
    if (std::filesystem::path(options.for_printer).extension() == ".gcvf" &&
        std::ranges::find(options.formats, gcvf) == options.formats.end())
        options.formats.push_back(gcvf);
}

}  // namespace

void add_some_job_options(CLI::App& command, JobArguments& arguments, const std::vector<std::string>& keys) {
    for (const OptionSpec& spec : slicer::slice_option_table())
        if (std::ranges::find(keys, spec.key) != keys.end()) add_option(command, spec, arguments);
}

void add_job_options(CLI::App& command, JobArguments& arguments, const std::vector<std::string>& without) {
    for (const OptionSpec& spec : slicer::slice_option_table())
        if (std::ranges::find(without, spec.key) == without.end()) add_option(command, spec, arguments);
    constexpr int most_copies = 10'000;  // as in a plan
    if (arguments.takes_many)
        command
            .add_option("--copies", arguments.copies,
                        "of each model: a tray of so many, looped once and laid beside each other")
            ->type_name("N")
            ->check(CLI::Range(1, most_copies))
            ->group("Tray");
    command
        .add_option("--job", arguments.job,
                    "read options from this job file; the command line wins. Paths in it are seen from its folder")
        ->type_name("FILE")
        ->group("Run");
}

void add_dump_default(CLI::App& command, JobArguments& arguments) {
    command
        .add_flag("--dump-default", arguments.dump_default,
                  "print a complete job file, with the options given and every default, and stop")
        ->group("Run");
}

slicer::SliceOptions options_of(const JobArguments& arguments) {
    slicer::SliceOptions options;
    std::vector<std::string> named;
    if (!arguments.job.empty()) slicer::read_job(arguments.job, options);
    for (const OptionSpec& spec : slicer::slice_option_table()) {
        const std::optional<std::string> value = said(arguments, spec, options);
        if (!value) continue;
        spec.set(options, *value);
        named.push_back(spec.key);
    }
    if (std::any_of(named.begin(), named.end(), slicer::decides_scope)) options.named.clear();
    options.named.insert(options.named.end(), named.begin(), named.end());
    take_one_file(options);
    add_format_for_printer(options);
    return options;
}

slicer::TrayModels many_models(const JobArguments& arguments, const slicer::SliceOptions& options) {
    slicer::TrayModels models{arguments.models, arguments.copies};
    if (models.empty() && !options.model.empty()) models.files = {options.model};
    if (models.copies == 1 && models.files.size() < 2) return {};
    constexpr std::array units{"um", "mm", "cm", "m", "in", "ft", "pt"};
    for (const std::string& model : models.files) {
        if (std::ranges::find(units, model) != units.end() && !std::filesystem::exists(model))
            throw UsageError(
                fmt::format("'{}' is a unit and no model: lengths have no space in them, as 12{}", model, model));
        slicer::SliceOptions one;
        one.model = model;
        if (!slicer::is_tray(one) && !farm::is_plan(model)) continue;
        throw UsageError(
            models.files.size() > 1
                ? fmt::format("{}: name one plan, or models and pictures; a plan names its parts itself", model)
                : fmt::format("{}: --copies is of models; in a plan each part says its \"copies\"", model));
    }
    return models;
}

JobResult run_tray(const slicer::SliceOptions& options, const slicer::TrayModels& models, Progress& progress) {
    return options.shard.empty() ? slicer::run_tray_job(options, models, progress)
                                 : slicer::run_tray_shard(options, models, progress);
}

void tell_notes(const slicer::SliceOptions& options, Progress& progress) {
    for (const std::string& note : options.notes) progress.note(note);
}

}  // namespace voxtone::cli

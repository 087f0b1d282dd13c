// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/print/job_options.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "farm/batch/plan_rows.h"
#include "io/layers/layer_format.h"
#include "slicer/options/job_file.h"
#include "slicer/options/option_scope.h"
#include "slicer/options/option_table.h"
#include "slicer/options/option_values.h"

namespace voxtone::cli {

namespace {

using slicer::OptionSpec;

/// "model,--model", "-o,--out".
std::string names_of_option(const OptionSpec& spec) {
    std::string names = "--" + spec.key;
    if (!spec.letter.empty()) names = "-" + spec.letter + "," + names;
    return spec.positional ? spec.key + "," + names : names;
}

void add_option(Verb& verb, const OptionSpec& spec, JobArguments& arguments) {
    const std::string names = names_of_option(spec);
    arguments.keys.insert(spec.key);
    OptionRules rules{.unit = spec.metavar,
                      .choices = spec.choices,
                      .verb_checks = true,
                      .bare = !spec.bare.empty(),
                      .group = spec.group};
    if (spec.key == "model" && arguments.takes_many) return verb.add(names, arguments.models, spec.help, rules);
    rules.one_each = spec.kind() == OptionSpec::Kind::texts;  // said once for each text
    if (rules.one_each) return verb.add(names, arguments.texts[spec.key], spec.help, rules);
    rules.usual = spec.get(slicer::SliceOptions{});
    rules.off = spec.kind() == OptionSpec::Kind::flag;
    if (!rules.off) return verb.add(names, arguments.values[spec.key], spec.help, rules);
    arguments.flags[spec.key] = rules.usual == "true";
    verb.add(names, arguments.flags[spec.key], spec.help, rules);
}

/// What the command line says of an option; nothing: it does not name it.
std::optional<std::string> said(const JobArguments& arguments, const OptionSpec& spec) {
    if (!arguments.keys.contains(spec.key) || !arguments.said->contains(spec.key)) return std::nullopt;
    if (spec.kind() == OptionSpec::Kind::flag) return arguments.flags.at(spec.key) ? "true" : "false";
    if (spec.key == "model" && arguments.takes_many) return arguments.models.front();
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

void add_some_job_options(Verb& command, JobArguments& arguments, const std::vector<std::string>& keys) {
    arguments.said = command.said;
    for (const OptionSpec& spec : slicer::slice_option_table())
        if (std::ranges::find(keys, spec.key) != keys.end()) add_option(command, spec, arguments);
}

void add_job_options(Verb& command, JobArguments& arguments, const std::vector<std::string>& without) {
    arguments.said = command.said;
    for (const OptionSpec& spec : slicer::slice_option_table())
        if (std::ranges::find(without, spec.key) == without.end()) add_option(command, spec, arguments);
    constexpr int most_copies = 10'000;  // as in a plan
    if (arguments.takes_many)
        command.add("--copies", arguments.copies,
                    "of each model: a tray of so many, looped once and laid beside each other",
                    {.range = {1, most_copies}, .group = "Tray"});
    command.add("--job", arguments.job,
                "read options from this job file; the command line wins. Paths in it are seen from its folder",
                {.unit = "FILE", .group = "Run"});
}

void add_dump_default(Verb& command, JobArguments& arguments) {
    command.add("--dump-default", arguments.dump_default,
                "print a complete job file, with the options given and every default, and stop", {.group = "Run"});
}

slicer::SliceOptions options_of(const JobArguments& arguments) {
    slicer::SliceOptions options;
    std::vector<std::string> named;
    if (!arguments.job.empty()) slicer::read_job(arguments.job, options);
    for (const OptionSpec& spec : slicer::slice_option_table()) {
        const std::optional<std::string> value = said(arguments, spec);
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
        // As other programs take it.
        if (models.files.size() == 2 && model == models.files[1] && !std::filesystem::exists(model) &&
            std::filesystem::path(model).extension().empty())
            throw UsageError(
                fmt::format("there is no model '{}'; if it is the folder for the print, write -o {}", model, model));
        if (!farm::is_plan(model)) continue;
        throw UsageError(
            models.files.size() > 1
                ? fmt::format("{}: name one plan, or models and pictures; a plan names its parts itself", model)
                : fmt::format("{}: --copies is of models; in a plan each part says its \"copies\"", model));
    }
    return models;
}

}  // namespace voxtone::cli

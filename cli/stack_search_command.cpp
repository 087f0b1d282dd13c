// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "voxtone/base/parallel.h"
#include "voxtone/base/units.h"
#include "voxtone/cli/console.h"
#include "voxtone/cli/stack_commands.h"
#include "voxtone/slicer/stacks/stack_search_job.h"

namespace voxtone::cli {

namespace {

struct StackSearchArguments {
    slicer::StackSearchJob job;
    std::string thickness = "5mm", known = "0", layer = "0", reach = "10mm";
    int threads = 0;
    ConsoleOptions console;
};

int run(StackSearchArguments& a) {
    a.job.thickness_mm = parse_length_mm(a.thickness, "--thickness");
    a.job.known_mm = parse_length_mm(a.known, "--known");
    a.job.layer_mm = parse_length_mm(a.layer, "--layer");
    a.job.setting.reach_mm = parse_length_mm(a.reach, "--reach");
    const ThreadLimit limit(static_cast<std::size_t>(a.threads));
    return run_on_console(a.console, [&](Progress& progress) {
        slicer::StackJobResult result = slicer::run_stack_search(a.job, progress);
        return CommandResult{std::move(result.json), std::move(result.text)};
    });
}

}  // namespace

Command add_stack_search_command(CLI::App& stack) {
    auto arguments = std::make_shared<StackSearchArguments>();
    slicer::StackSearchJob& job = arguments->job;
    CLI::App* command = stack.add_subcommand("search", "Find the layers whose reflection spreads light as wanted");
    const auto length = [&](const char* name, std::string& value, const char* help) {
        return command->add_option(name, value, help)->type_name("LENGTH")->capture_default_str();
    };
    command
        ->add_option("targets", job.targets, "profiles of what is wanted (voxtone-profile); of a measured layer, its R")
        ->type_name("FILE")
        ->required();
    command->add_option("-o,--out", job.out, "folder for NAME.stack.json and NAME.svg of each target")
        ->type_name("FOLDER")
        ->required();
    command->add_flag("--overwrite", job.overwrite, "replace files of the same names in the folder");
    command
        ->add_option("--materials", job.setting.materials,
                     "roles of resins (W,K,T) or profile files of measured layers")
        ->type_name("ROLES|FILES")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->required();
    command->add_option("--resins", job.setting.resins, "resin set (`voxtone list resins`) or file")
        ->type_name("SET|FILE")
        ->capture_default_str();
    length("--thickness", arguments->thickness, "most thickness of a stack");
    command->add_option("--steps", job.steps, "of thickness: blocks are 1, 2, 4, ... steps thick")
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--max-blocks", job.max_blocks, "most blocks of a stack")
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--dc-weight", job.dc_weight, "weight of the total, the other coefficients have 1")
        ->type_name("W")
        ->capture_default_str();
    command->add_option("--clear-top", job.clear_top, "a material stays that far from the top: T=0.2mm")
        ->type_name("MATERIAL=LENGTH")
        ->delimiter(',')
        ->allow_extra_args(false);
    command
        ->add_option("--backing", job.setting.backing,
                     "below the stack, in contact: black, white, air, or a profile file")
        ->type_name("WHAT")
        ->capture_default_str();
    command
        ->add_option("--surface", job.setting.surface,
                     "on top: air (smooth), matched (none); auto: air for resins [auto|air|matched]")
        ->capture_default_str();
    command->add_flag("--refine,!--no-refine", job.refine, "thicknesses between the steps (default), or not");
    length("--layer", arguments->layer, "of the printer: borders lie between printed layers; 0: anywhere");
    length("--known", arguments->known, "thickness at which the profiles of resins are made; 0: what fits each");
    command->add_option("--rounds", job.rounds, "searches, each corrected by Monte Carlo; 0: layer profiles alone")
        ->type_name("N")
        ->capture_default_str();
    length("--reach", arguments->reach, "radius of the disc that coefficients belong to");
    command->add_option("--coefficients", job.setting.coefficients, "per channel; detail is reach / N")
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--paths", job.paths, "per traced layer or stack, and channel")
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--seed", job.seed, "seed of traced light")->type_name("N")->capture_default_str();
    add_threads_option(*command, arguments->threads);
    add_console_options(*command, arguments->console);
    return [arguments] { return run(*arguments); };
}

}  // namespace voxtone::cli

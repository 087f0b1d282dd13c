// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>

#include <CLI/CLI.hpp>

#include "cli/laminate/laminate_commands.h"
#include "cli/laminate/laminate_options.h"
#include "cli/program/help.h"
#include "scattering/jobs/laminate_search_job.h"

namespace voxtone::cli {

namespace {

struct LaminateSearchArguments {
    scattering::LaminateSearchJob job;
    RunOptions run;
};

int run(LaminateSearchArguments& a) {
    return run_on_console(a.run, [&](Progress& progress) { return scattering::run_laminate_search(a.job, progress); });
}

void add_material_options(CLI::App& command, scattering::LaminateSettingOptions& setting) {
    command.add_option("--materials", setting.materials, "roles of resins (W,K,T) or profile files of measured layers")
        ->type_name("ROLES|FILES")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->required();
    add_resins_option(command, setting.resins);
}

/// What may be found.
void add_laminate_options(CLI::App& command, scattering::LaminateSearchJob& job, LengthOptions& lengths) {
    lengths.add(command, "--thickness", job.thickness_mm, "most thickness of a laminate");
    add_count(command, "--steps", job.steps, "of thickness: blocks are 1, 2, 4, ... steps thick");
    add_count(command, "--max-blocks", job.max_blocks, "most blocks of a laminate");
    add_value(command, "--dc-weight", job.dc_weight, "weight of the total, the other coefficients have 1")
        ->type_name("W");
    command.add_option("--clear-top", job.clear_top, "a material stays that far from the top: T=0.2mm")
        ->type_name("MATERIAL=LENGTH")
        ->delimiter(',')
        ->allow_extra_args(false);
    add_value(command, "--backing", job.setting.backing,
              "below the laminate, in contact: black, white, air, or a profile file")
        ->type_name("WHAT");
    add_value(command, "--surface", job.setting.surface,
              "on top: air (smooth), matched (none); auto: air for resins [auto|air|matched]");
    command.add_flag("--refine,!--no-refine", job.refine, "thicknesses between the steps (default), or not");
    lengths.add(command, "--layer", job.layer_mm, "of the printer: borders lie between printed layers; 0: anywhere");
    lengths.add(command, "--known", job.known_mm,
                "thickness at which the profiles of resins are made; 0: what fits each");
}

}  // namespace

Command add_laminate_search_command(CLI::App& laminate) {
    auto arguments = std::make_shared<LaminateSearchArguments>();
    scattering::LaminateSearchJob& job = arguments->job;
    LengthOptions& lengths = arguments->run.lengths;
    CLI::App* command = laminate.add_subcommand("search", "Find the layers whose reflection spreads light as wanted");
    command
        ->add_option("targets", job.targets, "profiles of what is wanted (voxtone-profile); of a measured layer, its R")
        ->type_name("FILE")
        ->required();
    add_file_folder_options(*command, job.out, job.overwrite,
                            "folder for NAME.laminate.json and NAME.svg of each target");
    add_material_options(*command, job.setting);
    add_laminate_options(*command, job, lengths);
    add_count(*command, "--rounds", job.rounds, "searches, each corrected by Monte Carlo; 0: layer profiles alone");
    add_detail_options(*command, lengths, job.setting.reach_mm, job.setting.coefficients);
    add_tracing_options(*command, job.paths, job.seed);
    add_run_options(*command, arguments->run);
    add_example(*command, "wanted.json --materials W,K -o found");
    return [arguments] { return run(*arguments); };
}

}  // namespace voxtone::cli

// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>

#include "cli/laminate/laminate_commands.h"
#include "cli/laminate/laminate_options.h"
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

void add_material_options(Verb& command, scattering::LaminateSettingOptions& setting) {
    command.add("--materials", setting.materials, "roles of resins (W,K,T) or profile files of measured layers",
                {.unit = "ROLES|FILES", .required = true, .one_each = true, .separator = ','});
    add_resins_option(command, setting.resins);
}

/// What may be found.
void add_laminate_options(Verb& command, scattering::LaminateSearchJob& job) {
    command.add("--thickness", length(job.thickness_mm), "most thickness of a laminate");
    command.add("--steps", job.steps, "of thickness: blocks are 1, 2, 4, ... steps thick");
    command.add("--max-blocks", job.max_blocks, "most blocks of a laminate");
    command.add("--dc-weight", job.dc_weight, "weight of the total, the other coefficients have 1", {.unit = "W"});
    command.add("--edge-weights", job.edge,
                "others have what they do beyond the edge of a shadow, 1 / k^2: widths are nearer, middles farther");
    command.add("--clear-top", job.clear_top, "a material stays that far from the top: T=0.2mm",
                {.unit = "MATERIAL=LENGTH", .one_each = true, .separator = ','});
    command.add("--backing", job.setting.backing,
                "below the laminate, in contact: black, white, air, or a profile file", {.unit = "WHAT"});
    command.add("--surface", job.setting.surface, "on top: air (smooth), matched (none); auto: air for resins",
                {.choices = {"auto", "air", "matched"}});
    command.add("--refine", job.refine, "thicknesses between the steps, or not", {.off = true});
    command.add("--layer", length(job.layer_mm), "of the printer: borders lie between printed layers; 0: anywhere");
    command.add("--known", length(job.known_mm),
                "thickness at which the profiles of resins are made; 0: what fits each");
}

}  // namespace

Verb laminate_search_verb() {
    auto arguments = std::make_shared<LaminateSearchArguments>();
    scattering::LaminateSearchJob& job = arguments->job;
    Verb command("search", "Find the layers whose reflection spreads light as wanted",
                 "wanted.json --materials W,K -o found");
    command.add("targets", job.targets, "profiles of what is wanted (voxtone-profile); of a measured layer, its R",
                {.unit = "FILE", .required = true});
    add_file_folder_options(command, job.out, job.overwrite,
                            "folder for NAME.laminate.json and NAME.svg of each target");
    add_material_options(command, job.setting);
    add_laminate_options(command, job);
    command.add("--rounds", job.rounds, "searches, each corrected in all directions; 0: layer profiles alone");
    add_detail_options(command, job.setting.reach_mm, job.setting.coefficients);
    add_tracing_options(command, job.paths, job.seed);
    add_run_options(command, arguments->run);
    command.run = [arguments] { return run(*arguments); };
    return command;
}

}  // namespace voxtone::cli

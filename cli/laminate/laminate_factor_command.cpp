// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/laminate/laminate_commands.h"
#include "cli/program/common_options.h"
#include "cli/program/help.h"
#include "scattering/jobs/laminate_factor_job.h"

namespace voxtone::cli {

namespace {

struct LaminateFactorArguments {
    scattering::LaminateFactorJob job;
    std::vector<std::uint32_t> point;
    double max_albedo = 0;
    RunOptions run;
};

int run(LaminateFactorArguments& a) {
    if (a.max_albedo != 0) a.job.map.max_albedo = a.max_albedo;
    if (!a.point.empty()) a.job.point = {a.point[0], a.point[1]};
    return run_on_console(a.run, [&](Progress& progress) { return scattering::run_laminate_factor(a.job, progress); });
}

void add_map_options(CLI::App& command, LaminateFactorArguments& a) {
    scattering::ProfileMapOptions& map = a.job.map;
    add_value(command, "--clusters", map.clusters.clusters, "profiles to keep, at most")->check(CLI::Range(1, 65535));
    add_value(command, "--max-albedo", a.max_albedo,
              "scale all profiles so that the brightest reflects this much; 0: as they are")
        ->check(CLI::Range(0.0, 1.0));
    add_value(command, "--curvature", map.factor.curvature,
              "how much the slope of ln P is expected to change from point to point; smaller is smoother");
    add_value(command, "--tolerance", map.factor.tolerance,
              "share of the light that may be left out of place when it stops");
    add_value(command, "--steps", map.factor.max_steps, "most steps");
}

}  // namespace

Command add_laminate_factor_command(CLI::App& laminate) {
    auto arguments = std::make_shared<LaminateFactorArguments>();
    LaminateFactorArguments& a = *arguments;
    CLI::App* command = laminate.add_subcommand("factor",
                                                "Find the scattering profile of each point of a heterogeneous surface, "
                                                "and the few that stand for all: a profile map");
    command->add_option("dataset", a.job.dataset, "data set: measured, or of `laminate dataset`")
        ->type_name("FILE")
        ->required();
    add_out_option(*command, a.job.out, "FILE", "profile map to write: NAME.json, with NAME.png beside it");
    add_overwrite_option(*command, a.job.overwrite);
    add_map_options(*command, a);
    command
        ->add_option("--check", a.job.check,
                     "other data of the same surface: says how far profiles are wrong, without the noise")
        ->type_name("FILE");
    command->add_option("--picture", a.job.picture, "write data, factored and clustered surface side by side")
        ->type_name("PNG");
    command->add_option("--point", a.point, "X,Y of the point whose response is drawn; by default one in the middle")
        ->delimiter(',')
        ->expected(2);
    add_seed_option(*command, a.job.map.clusters.seed, "seed of the clusters");
    add_run_options(*command, a.run);
    add_example(*command, "marble.bssrdf --clusters 16 -o vein.json");
    return [arguments] { return run(*arguments); };
}

}  // namespace voxtone::cli

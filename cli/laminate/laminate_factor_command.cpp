// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>
#include <vector>

#include "cli/laminate/laminate_commands.h"
#include "cli/program/common_options.h"
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

void add_map_options(Verb& command, LaminateFactorArguments& a) {
    scattering::ProfileMapOptions& map = a.job.map;
    command.add("--clusters", map.clusters.clusters, "profiles to keep, at most", {.range = {1, 65535}});
    command.add("--max-albedo", a.max_albedo,
                "scale all profiles so that the brightest reflects this much; 0: as they are", {.range = {0.0, 1.0}});
    command.add("--curvature", map.factor.curvature,
                "how much the slope of ln P is expected to change from point to point; smaller is smoother");
    command.add("--tolerance", map.factor.tolerance, "share of the light that may be left out of place when it stops");
    command.add("--steps", map.factor.max_steps, "most steps");
}

}  // namespace

Verb laminate_factor_verb() {
    auto arguments = std::make_shared<LaminateFactorArguments>();
    LaminateFactorArguments& a = *arguments;
    Verb command("factor",
                 "Find the scattering profile of each point of a heterogeneous surface, "
                 "and the few that stand for all: a profile map",
                 "marble.bssrdf --clusters 16 -o vein.json");
    command.add("dataset", a.job.dataset, "data set: measured, or of `laminate dataset`",
                {.unit = "FILE", .required = true});
    add_out_option(command, a.job.out, "FILE", "profile map to write: NAME.json, with NAME.png beside it");
    add_overwrite_option(command, a.job.overwrite);
    command.add("--luminance", a.job.luminance,
                "of the data alone, as in the paper: a map of one channel, which asks the same of each channel of the "
                "resins");
    command.add("--tint", a.job.tint,
                "of the data as seen through a skin of a picture's colours: colour and spreading at once",
                {.unit = "PICTURE", .not_with = "--luminance"});
    add_map_options(command, a);
    command.add("--check", a.job.check,
                "other data of the same surface: says how far profiles are wrong, without the noise", {.unit = "FILE"});
    command.add("--picture", a.job.picture, "write data, factored and clustered surface side by side", {.unit = "PNG"});
    command.add("--point", a.point, "X,Y of the point whose response is drawn; by default one in the middle",
                {.separator = ',', .count = {2, 2}});
    command.add("--seed", a.job.map.clusters.seed, "seed of the clusters");
    add_run_options(command, a.run);
    command.run = [arguments] { return run(*arguments); };
    return command;
}

}  // namespace voxtone::cli

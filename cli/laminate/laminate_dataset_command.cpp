// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>
#include <vector>

#include "cli/laminate/laminate_commands.h"
#include "cli/program/common_options.h"
#include "scattering/jobs/laminate_dataset_job.h"

namespace voxtone::cli {

namespace {

struct LaminateDatasetArguments {
    scattering::LaminateDatasetJob job;
    std::string pattern;
    std::vector<std::uint32_t> points{64};
    RunOptions run;
};

std::vector<std::string> pattern_names() {
    std::vector<std::string> names;
    for (const auto& [name, pattern] : scattering::slab_pattern_names) names.emplace_back(name);
    return names;
}

int run(LaminateDatasetArguments& a) {
    for (const auto& [name, pattern] : scattering::slab_pattern_names)
        if (name == a.pattern) a.job.slab.pattern = pattern;
    a.job.slab.width = a.points.front();
    a.job.slab.height = a.points.back();
    return run_on_console(a.run, [&](Progress& progress) { return scattering::run_laminate_dataset(a.job, progress); });
}

void add_slab_options(Verb& command, LaminateDatasetArguments& a) {
    command.add("--points", a.points, "points a side, or WIDTH,HEIGHT",
                {.range = {1, 4096}, .separator = ',', .count = {1, 2}});
    command.add("--pitch", length(a.job.slab.pitch_mm), "between points");
    command.add("--thickness", length(a.job.slab.thickness_mm), "of the slab; it lies on black");
    command.add("--layer", length(a.job.slab.layer_mm), "depth of its voxels");
    command.add("--feature", length(a.job.slab.feature_mm), "edge of a square, distance of veins, size of grains");
}

}  // namespace

Verb laminate_dataset_verb() {
    auto arguments = std::make_shared<LaminateDatasetArguments>();
    LaminateDatasetArguments& a = *arguments;
    Verb command("dataset",
                 "Trace how light that enters a heterogeneous slab at one point leaves it "
                 "at the others: a data set for `laminate factor`",
                 "marble -o marble.bssrdf");
    command.add("pattern", a.pattern, "marble: veins; chess: white on black and translucent squares; stone: grains",
                {.choices = pattern_names(), .required = true});
    add_out_option(command, a.job.out, "FILE", "data set to write (format: docs/bssrdf.md)");
    add_overwrite_option(command, a.job.overwrite);
    add_slab_options(command, a);
    command.add("--radius", a.job.radius, "of the window around a point, in points", {.range = {1, 64}});
    command.add("--paths", a.job.paths, "per point and channel; a value's noise falls with the root of their number",
                {.range = {1, 1 << 24}});
    add_resins_option(command, a.job.resins, ", with roles W, K and T");
    command.add("--matched", a.job.matched,
                "no refractive surface (index-matched on both sides), as stacked profiles have it");
    command.add("--seed", a.job.slab.seed, "seed of the pattern and the paths");
    command.add("--path-seed", a.job.path_seed, "seed of the paths alone: the same slab seen once more");
    add_run_options(command, a.run);
    command.run = [arguments] { return run(*arguments); };
    return command;
}

}  // namespace voxtone::cli

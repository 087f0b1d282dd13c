// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/laminate/laminate_commands.h"
#include "cli/program/common_options.h"
#include "cli/program/help.h"
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

void add_slab_options(CLI::App& command, LaminateDatasetArguments& a) {
    command.add_option("--points", a.points, "points a side, or WIDTH,HEIGHT")
        ->delimiter(',')
        ->expected(1, 2)
        ->check(CLI::Range(1, 4096))
        ->capture_default_str();
    a.run.lengths.add(command, "--pitch", a.job.slab.pitch_mm, "between points");
    a.run.lengths.add(command, "--thickness", a.job.slab.thickness_mm, "of the slab; it lies on black");
    a.run.lengths.add(command, "--layer", a.job.slab.layer_mm, "depth of its voxels");
    a.run.lengths.add(command, "--feature", a.job.slab.feature_mm,
                      "edge of a square, distance of veins, size of grains");
}

}  // namespace

Command add_laminate_dataset_command(CLI::App& laminate) {
    auto arguments = std::make_shared<LaminateDatasetArguments>();
    LaminateDatasetArguments& a = *arguments;
    CLI::App* command =
        laminate.add_subcommand("dataset",
                                "Trace how light that enters a heterogeneous slab at one point leaves it "
                                "at the others: a data set for `laminate factor`");
    command
        ->add_option("pattern", a.pattern,
                     "marble: veins; chess: white on black and translucent squares; stone: grains")
        ->check(CLI::IsMember(pattern_names()))
        ->required();
    add_out_option(*command, a.job.out, "FILE", "data set to write (format: docs/heterogeneous.md)");
    add_overwrite_option(*command, a.job.overwrite);
    add_slab_options(*command, a);
    add_value(*command, "--radius", a.job.radius, "of the window around a point, in points")->check(CLI::Range(1, 64));
    add_value(*command, "--paths", a.job.paths,
              "per point and channel; a value's noise falls with the root of their number")
        ->check(CLI::Range(1u, 1u << 24));
    add_resins_option(*command, a.job.resins, ", with roles W, K and T");
    command->add_flag("--matched", a.job.matched,
                      "no refractive surface (index-matched on both sides), as stacked profiles have it");
    add_seed_option(*command, a.job.slab.seed, "seed of the pattern and the paths");
    command->add_option("--path-seed", a.job.path_seed, "seed of the paths alone: the same slab seen once more")
        ->type_name("N");
    add_run_options(*command, a.run);
    add_example(*command, "marble -o marble.bssrdf");
    return [arguments] { return run(*arguments); };
}

}  // namespace voxtone::cli

// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>
#include <utility>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "base/units.h"
#include "cli/print/foreign_stack_options.h"
#include "cli/print/print_commands.h"
#include "cli/program/common_options.h"
#include "cli/program/console.h"
#include "cli/program/former_option.h"
#include "cli/program/help.h"
#include "slicer/predict/predict_job.h"

namespace voxtone::cli {

namespace {

struct PredictArguments {
    const CLI::App* command = nullptr;
    slicer::PredictOptions options;
    std::string cell = "0.085mm";
    FormerOption model;
    ConsoleOptions console;
};

/// An option of another model than the chosen one would be ignored.
void check_scope(const PredictArguments& a) {
    using Model = slicer::PredictionModel;
    for (const auto& [option, model] :
         {std::pair{"--sweeps", Model::transport}, std::pair{"--spp", Model::monte_carlo},
          std::pair{"--error", Model::monte_carlo}, std::pair{"--boundary", Model::monte_carlo}})
        if (a.command->count(option) > 0 && a.options.model != name_of(model))
            throw UsageError(
                fmt::format("{} would be ignored: it only goes with --predict {}", option, name_of(model)));
}

int run(PredictArguments& arguments) {
    check_scope(arguments);
    arguments.options.cell_mm = parse_length_mm(arguments.cell, "--cell");
    return run_on_console(arguments.console, [&](Progress& progress) {
        arguments.model.warn(progress);
        slicer::PredictResult result = slicer::run_predict_job(arguments.options, progress);
        return JobResult{std::move(result.json), std::move(result.text)};
    });
}

}  // namespace

Command add_predict_command(CLI::App& program) {
    auto arguments = std::make_shared<PredictArguments>();
    slicer::PredictOptions& o = arguments->options;
    CLI::App* command =
        program.add_subcommand("predict", "Predict what the print of a layer stack, ours or anyone's, will look like");
    arguments->command = command;
    const auto group = [&](const char* name, std::initializer_list<CLI::Option*> options) {
        for (CLI::Option* option : options) option->group(name);
    };
    group("Input and output",
          {command->add_option("stack", o.stack, "output folder, folder of PNG layers, or .gcvf file")
               ->required()
               ->type_name("FOLDER|FILE"),
           command
               ->add_option("-o,--out", o.files,
                            "file to write, several by repeating: of a slab from above .png (for the eye) or .exr "
                            "(numbers); of a body .glb or .ply "
                            "(vertex colours), .png (views); of either .html (a page to turn, probe and cut it)")
               ->required()
               ->type_name("FILE")
               ->allow_extra_args(false),
           add_overwrite_option(*command, o.overwrite),
           command
               ->add_option("--view", o.view,
                            "top: a picture from above; body: the whole surface; auto: top for pictures and flat boxes "
                            "[auto|top|body]")
               ->capture_default_str(),
           command->add_flag("--lit", o.lit,
                             ".glb: a material for lights (base colour, roughness, index, thickness and attenuation) "
                             "instead of unlit colours"),
           command->add_flag("--absolute", o.absolute,
                             "light that leaves / light that entered, instead of relative to the same body all of "
                             "white resin (role W)")});
    group(
        "Model",
        {command
             ->add_option("--predict", o.model,
                          fmt::format("by which model [{}]", fmt::join(names_of<slicer::PredictionModel>(), "|")))
             ->capture_default_str(),
         command
             ->add_option("--cell", arguments->cell,
                          "what is seen as one: edge of the cells, rounded to whole voxels; from twice the default on "
                          "transport takes a quick look: ten times as fast, up to 2 CIEDE2000 off in fine patterns")
             ->type_name("LENGTH")
             ->capture_default_str(),
         command
             ->add_option("--sweeps", o.quality.sweeps,
                          "transport: least sweeps of discrete ordinates, up to twice as many until one changes less "
                          "than 0.5 % of what is seen; more are nearer and slower")
             ->type_name("N")
             ->capture_default_str(),
         command
             ->add_option("--spp", o.quality.paths, "monte-carlo: paths per cell and channel (with --error: the least)")
             ->type_name("N")
             ->capture_default_str(),
         command
             ->add_option("--error", o.quality.error,
                          "monte-carlo: wanted standard error of every value; 0: --spp decides")
             ->type_name("E")
             ->capture_default_str(),
         command
             ->add_option("--boundary", o.boundary,
                          "monte-carlo: where light leaves a body; auto: at its mesh where job.json knows the model, "
                          "else at the faces of its voxels, which shows slanting faces too light [auto|mesh|voxels]")
             ->capture_default_str(),
         command
             ->add_option("--outside", o.outside,
                          "light that leaves one part of a body and meets another; followed: folds and cups darken as "
                          "they will on the table, the target's too, so it is not what a print is compared by; "
                          "monte-carlo follows paths and needs the mesh, other models gather it cell by cell, too "
                          "dark inside thin translucent walls [lost|followed]")
             ->capture_default_str(),
         command
             ->add_option("--backing", o.backing,
                          "what lies under the print [auto|black|white|none]; auto: what the job said, else black "
                          "under a slab, none under a body")
             ->capture_default_str()});
    arguments->model.add(*command, "--predict", "--model", o.model);
    add_foreign_stack_options(*command, o.resins, o.assign, o.nearest, o.printer, o.pitch);
    group("Run", {add_memory(*command, "--memory", o.memory_gib,
                             "most memory for volume and prediction, GiB; 0: half of the machine's"),
                  add_threads_option(*command, o.threads),
                  add_seed_option(*command, o.quality.seed, "seed of what is random (monte-carlo)")});
    add_console_options(*command, arguments->console);
    add_example(*command, "out/cow -o predicted.glb");
    return [arguments] { return run(*arguments); };
}

}  // namespace voxtone::cli

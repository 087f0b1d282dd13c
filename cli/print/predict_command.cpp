// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "cli/print/foreign_stack_options.h"
#include "cli/print/print_commands.h"
#include "cli/program/common_options.h"
#include "cli/program/console.h"
#include "slicer/predict/predict_job.h"

namespace voxtone::cli {

namespace {

struct PredictArguments {
    slicer::PredictOptions options;
    ConsoleOptions console;
};

/// An option of another model than the chosen one would be ignored.
void check_scope(const Verb::Said& said, const slicer::PredictOptions& options) {
    using Model = slicer::PredictionModel;
    for (const auto& [option, model] :
         {std::pair{"sweeps", Model::transport}, std::pair{"spp", Model::monte_carlo},
          std::pair{"error", Model::monte_carlo}, std::pair{"boundary", Model::monte_carlo}})
        if (said.contains(option) && options.model != name_of(model))
            throw UsageError(
                fmt::format("--{} would be ignored: it only goes with --predict {}", option, name_of(model)));
}

int run(const Verb::Said& said, const PredictArguments& arguments) {
    check_scope(said, arguments.options);
    return run_on_console(arguments.console, [&](Progress& progress) {
        slicer::PredictResult result = slicer::run_predict_job(arguments.options, progress);
        return JobResult{std::move(result.json), std::move(result.text)};
    });
}

}  // namespace

Verb predict_verb() {
    auto arguments = std::make_shared<PredictArguments>();
    slicer::PredictOptions& o = arguments->options;
    Verb command("predict", "Predict what the print of a layer stack, ours or anyone's, will look like",
                 "out/cow -o predicted.glb");
    command.group("Input and output");
    command.add("stack", o.stack, "output folder, folder of PNG layers, or .gcvf file",
                {.unit = "FOLDER|FILE", .required = true});
    command.add("-o,--out", o.files,
                "file to write, several by repeating: of a slab from above .png (for the eye) or .exr "
                "(numbers); of a body .glb or .ply "
                "(vertex colours), .png (views); of either .html (a page to turn, probe and cut it)",
                {.unit = "FILE", .required = true, .one_each = true});
    add_overwrite_option(command, o.overwrite);
    command.add("--view", o.view,
                "top: a picture from above; body: the whole surface; auto: top for pictures and flat boxes",
                {.choices = {"auto", "top", "body"}});
    command.add("--lit", o.lit,
                ".glb: a material for lights (base colour, roughness, index, thickness and attenuation) "
                "instead of unlit colours");
    command.add("--absolute", o.absolute,
                "light that leaves / light that entered, instead of relative to the same body all of "
                "white resin (role W)");
    command.group("Model");
    command.add("--predict", o.model, "by which model", {.choices = names_of<slicer::PredictionModel>()});
    command.add("--cell", length(o.cell_mm),
                "what is seen as one: edge of the cells, rounded to whole voxels; from twice the default on "
                "transport takes a quick look: ten times as fast, up to 2 CIEDE2000 off in fine patterns");
    command.add("--sweeps", o.quality.sweeps,
                "transport: least sweeps of discrete ordinates, up to twice as many until one changes less "
                "than 0.5 % of what is seen; more are nearer and slower");
    command.add("--spp", o.quality.paths, "monte-carlo: paths per cell and channel (with --error: the least)");
    command.add("--error", o.quality.error, "monte-carlo: wanted standard error of every value; 0: --spp decides",
                {.unit = "E"});
    command.add("--boundary", o.boundary,
                "monte-carlo: where light leaves a body; auto: at its mesh where job.json knows the model, "
                "else at the faces of its voxels, which shows slanting faces too light",
                {.choices = {"auto", "mesh", "voxels"}});
    command.add("--outside", o.outside,
                "light that leaves one part of a body and meets another; followed: folds and cups darken as "
                "they will on the table, the target's too, so it is not what a print is compared by; "
                "monte-carlo follows paths and needs the mesh, other models gather it cell by cell, too "
                "dark inside thin translucent walls",
                {.choices = {"lost", "followed"}});
    command.add(
        "--light", o.light,
        "front: by light that falls on it; behind: by that of a wide source behind a slab; auto: as the job said",
        {.choices = {"auto", "front", "behind"}});
    command.add("--backing", o.backing,
                std::string("what lies under the print: ") + slicer::backing_words +
                    "; auto: what the job said, else black under a slab, none under a body");
    add_illuminant_option(command, o.illuminant);
    add_foreign_stack_options(command, o.resins, o.assign, o.nearest, o.printer, o.pitch);
    command.group("Run");
    command.add("--memory", memory(o.memory_gib),
                "most memory for volume and prediction, GiB; 0: half of the machine's");
    add_threads_option(command, o.threads);
    command.add("--seed", o.quality.seed, "seed of what is random (monte-carlo)");
    add_console_options(command, arguments->console);
    command.run = [arguments, said = command.said] { return run(*said, *arguments); };
    return command;
}

}  // namespace voxtone::cli

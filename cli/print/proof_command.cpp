// SPDX-License-Identifier: GPL-3.0-or-later
#include <chrono>
#include <memory>
#include <string>
#include <utility>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "cli/print/foreign_stack_options.h"
#include "cli/print/print_commands.h"
#include "cli/program/common_options.h"
#include "cli/program/console.h"
#include "cli/program/help.h"
#include "slicer/proof/proof_job.h"

namespace voxtone::cli {

namespace {

struct ProofArguments {
    slicer::ProofOptions options;
    ConsoleOptions console;
};

void group(const char* name, std::initializer_list<CLI::Option*> options) {
    for (CLI::Option* option : options) option->group(name);
}

void add_camera_options(CLI::App& command, slicer::ProofOptions& o) {
    group("Camera",
          {command
               .add_option("--view", o.view,
                           fmt::format("by the side that is seen; auto: top for pictures, three-quarter for "
                                       "bodies [auto|{}]",
                                       fmt::join(names_of<slicer::ProofView>(), "|")))
               ->capture_default_str(),
           command
               .add_option("--up", o.up,
                           "which way of the model as printed is up where the print stands "
                           "[z|-z|y|-y|x|-x]")
               ->capture_default_str(),
           command
               .add_option("--turn", o.turn_deg, "turns the print on its table, degrees, counter-clockwise from above")
               ->type_name("DEG")
               ->capture_default_str(),
           command
               .add_option("--camera", o.camera,
                           "where the camera stands, mm in the model's frame as printed; empty: by --view, so "
                           "far off that all fits")
               ->type_name("X,Y,Z"),
           command.add_option("--look-at", o.look_at, "what it looks at, mm; empty: the middle of the box")
               ->type_name("X,Y,Z"),
           command.add_option("--focal", o.focal_mm, "focal length, mm, for a frame of 36 mm")
               ->type_name("MM")
               ->capture_default_str(),
           command.add_option("--size", o.size, "of the picture, pixels")->type_name("WxH")->capture_default_str(),
           command
               .add_option("--exposure", o.exposure_ev,
                           "of the .png, EV: 0 shows a white diffuser that lies in the open as white")
               ->type_name("EV")
               ->capture_default_str()});
}

void add_scene_options(CLI::App& command, slicer::ProofOptions& o) {
    group(
        "Light and scene",
        {command
             .add_option("--light", o.light,
                         "studio: two soft boxes and white walls; overcast: the CIE's overcast sky; even: the same "
                         "from everywhere; or a lat-long picture of a place (.exr) [studio|overcast|even|FILE]")
             ->capture_default_str(),
         command.add_option("--turn-light", o.turn_light_deg, "degrees, counter-clockwise from above")
             ->type_name("DEG")
             ->capture_default_str(),
         command.add_option("--ground", o.ground, "reflectance of the plane that the print lies on, or none")
             ->type_name("R|none")
             ->capture_default_str(),
         command
             .add_option("--finish", o.finish,
                         "glossy: as jetted, and matt where support lay; matt: support lay everywhere [glossy|matt]")
             ->capture_default_str(),
         command
             .add_option("--roughness", o.roughness,
                         "alpha of GGX of glossy and of matt faces, 0 is smooth; a guess until measured")
             ->type_name("A,B")
             ->delimiter(',')
             ->capture_default_str(),
         command.add_flag("--with-target", o.with_target,
                          "the model to the right of the print, with the same finish: its colours times the light that "
                          "thick white resin sends back")});
}

int run(ProofArguments& arguments) {
    return run_on_console(arguments.console,
                          [&](Progress& progress) { return slicer::run_proof_job(arguments.options, progress); });
}

}  // namespace

Command add_proof_command(CLI::App& program) {
    auto arguments = std::make_shared<ProofArguments>();
    slicer::ProofOptions& o = arguments->options;
    CLI::App* command = program.add_subcommand("proof", "Photograph the print of a layer stack by light paths");
    group(
        "Input and output",
        {command
             ->add_option("stacks", o.stacks, "output folders, folders of PNG layers, or .gcvf files: prints in a row")
             ->required()
             ->type_name("FOLDER|FILE"),
         command
             ->add_option("-o,--out", o.files,
                          "file to write, several by repeating: .png for the eye, .exr numbers with their standard "
                          "errors")
             ->required()
             ->type_name("FILE")
             ->allow_extra_args(false),
         add_overwrite_option(*command, o.overwrite)});
    add_camera_options(*command, o);
    add_scene_options(*command, o);
    group("Noise",
          {command
               ->add_option("--spp", o.samples,
                            "samples per pixel, in fours, at least 8 (with --error: the least); inside prints red has "
                            "half, blue a quarter of them")
               ->type_name("N")
               ->capture_default_str(),
           command
               ->add_option("--error", o.error,
                            "wanted standard error of luminance, rms over squares of 16 pixels, 1 is a white diffuser; "
                            "0: --spp decides")
               ->type_name("E")
               ->capture_default_str(),
           command
               ->add_option("--filter", o.filter_px,
                            "how far pixels gather their light: sigma of a Gaussian, as blurred as a camera's lens; 0: "
                            "each its own square")
               ->type_name("PX")
               ->capture_default_str()});
    add_foreign_stack_options(*command, o.resins, o.assign, o.nearest, o.printer, o.pitch);
    group("Run", {add_memory(*command, "--memory", o.memory_gib, "most memory, GiB; 0: half of the machine's"),
                  add_threads_option(*command, o.threads), add_seed_option(*command, o.seed, "seed of the paths")});
    add_console_options(*command, arguments->console);
    arguments->console.grace = std::chrono::seconds(20);  // what was drawn is written first
    add_example(*command, "out/cow -o proof.png");
    return [arguments] { return run(*arguments); };
}

}  // namespace voxtone::cli

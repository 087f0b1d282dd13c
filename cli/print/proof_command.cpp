// SPDX-License-Identifier: GPL-3.0-or-later
#include <chrono>
#include <memory>
#include <string>
#include <utility>

#include "cli/print/foreign_stack_options.h"
#include "cli/print/print_commands.h"
#include "cli/program/common_options.h"
#include "cli/program/console.h"
#include "slicer/proof/proof_job.h"

namespace voxtone::cli {

namespace {

struct ProofArguments {
    slicer::ProofOptions options;
    ConsoleOptions console;
};

std::vector<std::string> view_names() {
    std::vector<std::string> names = names_of<slicer::ProofView>();
    names.insert(names.begin(), "auto");
    return names;
}

void add_camera_options(Verb& command, slicer::ProofOptions& o) {
    command.group("Camera");
    command.add("--view", o.view, "by the side that is seen; auto: top for pictures, three-quarter for bodies",
                {.choices = view_names()});
    command.add("--up", o.up, "which way of the model as printed is up where the print stands",
                {.choices = {"z", "-z", "y", "-y", "x", "-x"}});
    command.add("--turn", o.turn_deg, "turns the print on its table, degrees, counter-clockwise from above",
                {.unit = "DEG"});
    command.add("--camera", o.camera,
                "where the camera stands, mm in the model's frame as printed; empty: by --view, so "
                "far off that all fits",
                {.unit = "X,Y,Z"});
    command.add("--look-at", o.look_at, "what it looks at, mm; empty: the middle of the box", {.unit = "X,Y,Z"});
    command.add("--focal", o.focal_mm, "focal length, mm, for a frame of 36 mm", {.unit = "MM"});
    command.add("--size", o.size, "of the picture, pixels", {.unit = "WxH"});
    command.add("--exposure", o.exposure_ev, "of the .png, EV: 0 shows a white diffuser that lies in the open as white",
                {.unit = "EV"});
}

void add_scene_options(Verb& command, slicer::ProofOptions& o) {
    command.group("Light and scene");
    command.add("--light", o.lights,
                "studio: two soft boxes and white walls; overcast: the CIE's overcast sky; even: the same "
                "from everywhere; behind: a source as wide as the sky behind the print; or a lat-long picture of a "
                "place (.exr); edge, slit, spot, laser: a beam on a part of what "
                "is seen, which shows translucency. Said again: one picture below the other",
                {.unit = "LIGHT",
                 .choices = {"studio", "overcast", "even", "behind", "edge", "slit", "spot", "laser", "FILE"},
                 .verb_checks = true,
                 .usual = "studio",
                 .one_each = true});
    command.add("--light-at", o.light_at,
                "where the beam falls: middle of what is seen, or a place of the surface, mm in the model's frame as "
                "printed",
                {.unit = "middle|X,Y,Z"});
    command.add("--light-width", length(o.light_width_mm),
                "of a slit, or across a spot or a laser, which sends as much light as the usual spot",
                {.usual = "1mm, spot 2mm"});
    command.add("--turn-light", o.turn_light_deg,
                "degrees, counter-clockwise from above; a beam's seen from outside, about its place: an edge across "
                "slabs is lit above, one on a body upright and lit on the left",
                {.unit = "DEG"});
    command.add("--ground", o.ground, "reflectance of the plane that the print lies on, or none", {.unit = "R|none"});
    command.add("--backing", o.backing,
                std::string("what lies under the first layer, as large as the print's box: ") + slicer::backing_words,
                {.unit = "SHEET"});
    command.add("--finish", o.finish, "glossy: as jetted, and matt where support lay; matt: support lay everywhere",
                {.choices = {"glossy", "matt"}});
    command.add("--roughness", o.roughness,
                "alpha of GGX of glossy and of matt faces, 0 is smooth; a guess until measured",
                {.unit = "A,B", .separator = ','});
    command.add("--with-target", o.with_target,
                "the model to the right of the print, with the same finish: its colours times the light that "
                "thick white resin sends back");
}

int run(ProofArguments& arguments) {
    return run_on_console(arguments.console,
                          [&](Progress& progress) { return slicer::run_proof_job(arguments.options, progress); });
}

}  // namespace

Verb proof_verb() {
    auto arguments = std::make_shared<ProofArguments>();
    slicer::ProofOptions& o = arguments->options;
    Verb command("proof", "Photograph the print of a layer stack by light paths", "out/cow -o proof.png");
    command.group("Input and output");
    command.add("stacks", o.stacks, "output folders, folders of PNG layers, or .gcvf files: prints in a row",
                {.unit = "FOLDER|FILE", .required = true});
    command.add("-o,--out", o.files,
                "file to write, several by repeating: .png for the eye, .exr numbers with their standard "
                "errors",
                {.unit = "FILE", .required = true, .one_each = true});
    add_overwrite_option(command, o.overwrite);
    add_camera_options(command, o);
    add_scene_options(command, o);
    command.group("Noise");
    command.add("--spp", o.samples,
                "samples per pixel, in fours, at least 8 (with --error: the least); inside prints red has "
                "half, blue a quarter of them");
    command.add("--error", o.error,
                "wanted standard error of luminance, rms over squares of 16 pixels, 1 is a white diffuser; "
                "0: --spp decides",
                {.unit = "E"});
    command.add("--filter", o.filter_px,
                "how far pixels gather their light: sigma of a Gaussian, as blurred as a camera's lens; 0: "
                "each its own square",
                {.unit = "PX"});
    add_illuminant_option(command, o.illuminant);
    add_foreign_stack_options(command, o.resins, o.assign, o.nearest, o.printer, o.pitch);
    command.group("Run");
    command.add("--memory", memory(o.memory_gib), "most memory, GiB; 0: half of the machine's");
    add_threads_option(command, o.threads);
    command.add("--seed", o.seed, "seed of the paths");
    add_console_options(command, arguments->console);
    arguments->console.grace = std::chrono::seconds(20);  // what was drawn is written first
    command.run = [arguments] { return run(*arguments); };
    return command;
}

}  // namespace voxtone::cli

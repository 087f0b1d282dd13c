// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/slice_options.h"

#include <algorithm>
#include <set>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/units.h"
#include "halftone/loop/appearance_loop.h"
#include "io/layers/layer_format.h"
#include "slicer/options/auto_limits.h"
#include "slicer/options/model_choice.h"
#include "slicer/options/option_values.h"
#include "slicer/options/option_words.h"

namespace voxtone::slicer {

namespace {

using Kind = OptionSpec::Kind;

OptionSpec spec(std::string key, Kind kind, std::string metavar, std::string group, std::string help,
                std::vector<std::string> choices = {}) {
    std::string option = key;
    return {std::move(key),
            std::move(option),
            kind,
            std::move(metavar),
            std::move(group),
            std::move(help),
            std::move(choices),
            {},
            {}};
}

/// Called otherwise on the command line than in the job file.
OptionSpec called(std::string option, OptionSpec s) {
    s.option = std::move(option);
    return s;
}

OptionSpec text(OptionSpec s, std::string SliceOptions::*member) {
    s.get = [member](const SliceOptions& o) { return o.*member; };
    s.set = [member, key = s.option, choices = s.choices](SliceOptions& o, const std::string& value) {
        if (!choices.empty() && std::find(choices.begin(), choices.end(), value) == choices.end())
            refuse_choice(key, value, choices);
        o.*member = value;
    };
    return s;
}

OptionSpec list(OptionSpec s, std::vector<std::string> SliceOptions::*member) {
    s.get = [member](const SliceOptions& o) { return fmt::format("{}", fmt::join(o.*member, ",")); };
    s.set = [member, key = s.option, choices = s.choices](SliceOptions& o, const std::string& value) {
        const std::vector<std::string> parts = parse_list(value);
        for (const std::string& part : parts)
            if (!choices.empty() && std::find(choices.begin(), choices.end(), part) == choices.end())
                refuse_choice(key, part, choices);
        if (std::set<std::string>(parts.begin(), parts.end()).size() != parts.size())
            throw UsageError(fmt::format("--{}: '{}' names something twice", key, value));
        o.*member = parts;
    };
    return s;
}

OptionSpec flag(OptionSpec s, bool SliceOptions::*member) {
    s.get = [member](const SliceOptions& o) { return std::string(o.*member ? "true" : "false"); };
    s.set = [member, key = s.option](SliceOptions& o, const std::string& value) { o.*member = parse_flag(key, value); };
    return s;
}

OptionSpec length(OptionSpec s, double SliceOptions::*member) {
    s.get = [member](const SliceOptions& o) { return fmt::format("{}mm", o.*member); };
    s.set = [member, key = s.option](SliceOptions& o, const std::string& value) {
        o.*member = parse_length_mm(value, "--" + key);
    };
    return s;
}

template <class Number>
OptionSpec number(OptionSpec s, Number SliceOptions::*member) {
    s.get = [member](const SliceOptions& o) { return fmt::format("{}", o.*member); };
    s.set = [member, key = s.option](SliceOptions& o, const std::string& value) {
        o.*member = parse_number<Number>(key, value);
    };
    return s;
}

OptionSpec names(OptionSpec::Names what, OptionSpec s) {
    s.names = what;
    return s;
}

OptionSpec of_the_run(OptionSpec s) {
    s.of_the_run = true;
    return s;
}

std::vector<OptionSpec> make_table() {
    using enum OptionSpec::Names;
    using O = SliceOptions;
    const std::string in = "Input and output", place = "Placement", colour = "Colour", body = "Body",
                      reading = "Limits of reading", loop = "Appearance loop", profiles = "Layered profiles",
                      predict = "Prediction", run = "Run";
    return {
        names(input, text(called("mesh", spec("model", Kind::text, "FILE", in,
                                              "textured mesh (OBJ, PLY, STL, glTF, GLB, 3MF) or picture")),
                          &O::model)),
        names(output,
              text(spec("out", Kind::text, "FOLDER", in, "output folder; nothing is written outside it"), &O::out)),
        list(spec("formats", Kind::list, "LIST", in,
                  "what to write: png (RGBA stack for Voxel Print), gcvf, tiff or png1 (one per resin and layer), vdb; "
                  "empty: the printer's default",
                  names_of<io::LayerFormat>()),
             &O::formats),
        of_the_run(flag(
            spec("overwrite", Kind::flag, "", in,
                 "replace a stack that the folder holds, make the same one again; other things in the folder stay"),
            &O::overwrite)),
        flag(spec("report", Kind::flag, "", in, "write report.html, target and predicted pictures"), &O::report),

        names(input_or_known,
              text(spec("printer", Kind::text, "ID|FILE", place, "printer profile; see `voxtone list printers`"),
                   &O::printer)),
        text(spec("unit", Kind::text, "UNIT", place,
                  "unit of the model's numbers: um, mm, cm, m, in, ft, or auto (the file's own; mm where it has none)"),
             &O::unit),
        length(
            spec("size", Kind::length, "LENGTH", place, "scale so that the largest extent is this; 0: leave the size"),
            &O::size_mm),
        number(spec("scale", Kind::number, "FACTOR", place, "scale by this factor; does not go with --size"),
               &O::scale),
        text(spec("rotate", Kind::text, "AXES", place,
                  "turn about the axes in this order, degrees, right-handed: x90 or z45,x-30"),
             &O::rotate),
        flag(spec("flip-x", Kind::flag, "", place, "mirror the print along x (columns of the bitmaps)"), &O::flip_x),
        flag(spec("flip-y", Kind::flag, "", place, "mirror the print along y (rows of the bitmaps)"), &O::flip_y),
        flag(spec("swap-xy", Kind::flag, "", place, "exchange x and y of the model (mirrors it; before the flips)"),
             &O::swap_xy),
        length(spec("width", Kind::length, "LENGTH", place,
                    "pictures: width of the slab; 0: from the picture's own resolution"),
               &O::width_mm),
        length(spec("thickness", Kind::length, "LENGTH", place, "pictures: thickness of the slab"), &O::thickness_mm),
        text(spec("layers", Kind::text, "A-B", place, "only these layers, counted from 0 at the bottom; empty: all"),
             &O::layers),

        names(input, text(spec("texture", Kind::text, "FILE", colour,
                               "picture for a mesh that has texture coordinates and no picture for them; those that "
                               "the mesh has stay; empty: none"),
                          &O::texture)),
        names(input_or_known, text(spec("resins", Kind::text, "SET|FILE", colour,
                                        "resin set; see `voxtone list resins`; empty: the printer's default"),
                                   &O::resins)),
        list(spec("load", Kind::list, "ROLES", colour,
                  "resins that are loaded, by role (C,M,Y,K,W); empty: the printer's default"),
             &O::load),
        text(spec("core", Kind::text, "ROLE", colour, "resin below the coloured shell"), &O::core),
        length(spec("depth", Kind::length, "LENGTH", colour,
                    "colour depth: how far below the surface voxels carry colour"),
               &O::depth_mm),
        text(spec("screen", Kind::text, "NAME", colour,
                  "halftone screen: blue-noise (position-addressed) or error-diffusion (three-dimensional)",
                  names_of<ScreenKind>()),
             &O::screen),
        text(spec("mixing", Kind::text, "HOW", colour,
                  "what the separation takes a mixture to be: voxels of the printer's size, between which light finds "
                  "its way, or ideal (averaged)",
                  names_of<Mixing>()),
             &O::mixing),
        text(spec("backing", Kind::text, "SHEET", colour, "pictures: what lies under the slab: black, white or none",
                  names_of<optics::Backing>()),
             &O::backing),

        text(spec("iterations", Kind::text, "N", loop,
                  fmt::format("how often the resins are rearranged after looking at the predicted print; 0: never; "
                              "auto: until it stops gaining, at most {}",
                              halftone::most_iterations)),
             &O::iterations),
        text(spec("intent", Kind::text, "NAME", loop,
                  "relative: the target's white is the white resin; absolute: it is a body that absorbs nothing; "
                  "contrast: relative, and where a "
                  "limit is met the surroundings give way too, so that local contrast is kept",
                  names_of<halftone::Intent>()),
             &O::intent),
        length(spec("viewing-distance", Kind::length, "LENGTH", loop,
                    "from where the print is looked at: what cannot be seen from there counts less"),
               &O::viewing_distance_mm),
        text(spec("loop-model", Kind::text, "MODEL", loop,
                  "what predicts the print in the loop; monte-carlo is for slabs of a few mm",
                  names_of<PredictionModel>()),
             &O::loop_model),
        text(spec("loop-method", Kind::text, "NAME", loop,
                  "feedback: each place corrects itself; descent: feedback, then along the gradient of the whole "
                  "print, which is sharper and takes "
                  "two to three times the time and 1.5 times the memory; auto: descent up to 15 cm2 of coloured "
                  "surface (of bodies 5, but with --intent contrast), feedback beyond",
                  names_of<LoopMethod>()),
             &O::loop_method),
        of_the_run(flag(spec("resume", Kind::flag, "", loop,
                             "go on with the loop of an interrupted job in the same output folder; with fewer "
                             "--iterations than it has made it prints the best of them"),
                        &O::resume)),

        of_the_run(names(input, text(spec("mixtures", Kind::text, "FILE", loop,
                                          "what the appearance loop came to, kept by --until loop: it is read and the "
                                          "loop not run; empty: OUT/skin.mixtures, if it is there"),
                                     &O::mixtures))),

        text(called("model", spec("arrange", Kind::text, "NAME", profiles,
                                  "what the surface is to show: colour, or layered-profile: how light spreads, by "
                                  "layers of resin under each point "
                                  "(docs/layered-prints.md); key `arrange` of a job file",
                                  names_of<Arrange>())),
             &O::arrange),
        names(input, text(spec("profiles", Kind::text, "MAP", profiles,
                               "map of wanted scattering profiles (voxtone-profile-map)"),
                          &O::profiles)),
        text(spec("profile-placement", Kind::text, "HOW", profiles,
                  "where on a mesh the map lies: uv (texture coordinates; it repeats) or box (projected along the main "
                  "axis of the normal, in mm; "
                  "mirrored beyond its edges); on a picture's slab it lies on the picture",
                  names_of<ProfilePlacement>()),
             &O::profile_placement),
        length(spec("stack-thickness", Kind::length, "LENGTH", profiles, "most thickness of a stack of layers"),
               &O::stack_thickness_mm),
        number(spec("stack-steps", Kind::number, "N", profiles, "the search cuts that thickness into so many steps"),
               &O::stack_steps),
        number(spec("stack-blocks", Kind::number, "N", profiles,
                    "and makes stacks of so many blocks, of 1, 2, 4, ... steps, at most"),
               &O::stack_blocks),
        text(spec("stack-rounds", Kind::text, "N", profiles,
                  "rounds in which a stack is searched, traced by Monte Carlo and corrected for what the layered model "
                  "got wrong; the best is kept; 0: by "
                  "the model alone; a round takes some ten seconds of one core for each cluster; auto: 1 for up to 16 "
                  "clusters of resins, else 0"),
             &O::stack_rounds),
        names(inputs_by_role,
              list(spec("stack-materials", Kind::list, "ROLE=FILE", profiles,
                        "measured profiles (voxtone-profile) of the loaded resins in the place of computed ones: "
                        "W=white.json,K=black.json; all or none"),
                   &O::stack_materials)),
        number(spec("dc-weight", Kind::number, "W", profiles,
                    "weight of the total reflectance against the profile's shape"),
               &O::dc_weight),
        list(spec("clear-top", Kind::list, "ROLE=LENGTH", profiles,
                  "this resin stays that far below the surface, such as T=0.2mm; a list"),
             &O::clear_top),
        text(spec("base", Kind::text, "ROLE", profiles, "resin below the stacks, taken to be deep"), &O::base),
        length(spec("layer-smoothing", Kind::length, "LENGTH", profiles,
                    "blur of the layers' thicknesses along the surface, standard deviation"),
               &O::layer_smoothing_mm),
        flag(spec("surfaces", Kind::flag, "", profiles,
                  "also write a closed mesh of each resin to OUT/surfaces, for printers fed with meshes"),
             &O::surfaces),
        length(spec("surface-cell", Kind::length, "LENGTH", profiles,
                    "cells that these meshes are made of; thinner layers have holes"),
               &O::surface_cell_mm),

        text(spec("repair", Kind::text, "HOW", body,
                  "broken meshes: off (refuse), auto (close holes; wrap what stays open) or wrap (always)",
                  names_of<RepairMode>()),
             &O::repair),
        flag(
            spec("keep-thin", Kind::flag, "", body, "features thinner than a voxel get one voxel instead of vanishing"),
            &O::keep_thin),

        text(spec("predict", Kind::text, "MODEL", predict,
                  fmt::format("what predicts the print for the report; none: the separation's own model, without "
                              "spreading light; auto: {} for "
                              "up to {:g} cm2 of coloured surface, else none",
                              name_of(PredictionModel::transport), auto_prediction_cm2),
                  predict_choices()),
             &O::predict),
        length(spec("predict-cell", Kind::length, "LENGTH", predict,
                    "cells that are predicted and seen as one; from twice the default on it is a quick look, averaged "
                    "over cells of the eye"),
               &O::predict_cell_mm),
        number(spec("verdict-good", Kind::number, "DE", predict,
                    "the print looks as asked where the mean difference as seen from the viewing distance is not above "
                    "this, CIEDE2000; a contract proof may have 2.5 (ISO 12647-7)"),
               &O::verdict_good),
        number(
            spec("verdict-bad", Kind::number, "DE", predict,
                 "and does not where it is above this: colours are taken for others; with --strict that is exit code "
                 "6, and the stack is there"),
            &O::verdict_bad),
        of_the_run(number(spec("memory", Kind::number, "GIB", predict,
                               "most memory for the loop and the prediction; a loop that needs more ends the job, a "
                               "prediction is left out; decides no bit; 0: half of the machine's"),
                          &O::memory_gib)),

        of_the_run(number(spec("read-memory", Kind::number, "GIB", reading,
                               "most memory for the program that reads the model and its pictures; 0: half of the "
                               "machine's, 8 at most"),
                          &O::read_memory_gib)),
        of_the_run(number(spec("read-time", Kind::number, "S", reading, "most time of the processor for it, s"),
                          &O::read_time_s)),
        of_the_run(number(spec("read-size", Kind::number, "GIB", reading,
                               "largest file that is read; also what all parts of a 3MF may unpack to"),
                          &O::read_size_gib)),
        of_the_run(number(spec("read-pixels", Kind::number, "MP", reading,
                               "largest picture or texture, million pixels; 268.4 are 16384 x 16384"),
                          &O::read_megapixels)),

        of_the_run(
            flag(spec("strict", Kind::flag, "", run,
                      "do not print what needs a look first: stop with exit code 3 where colours of the model "
                      "are lost, or where it would come out all white though it has colours; leave with exit code 6 "
                      "where the finished print will not look as asked (--verdict-bad)"),
                 &O::strict)),
        of_the_run(text(spec("shard", Kind::text, "I/N", run,
                             "make part I of N of the layers, 1 to N, cut by equal work; `voxtone merge OUT` lays them "
                             "together; auto or no value: as SLURM_ARRAY_TASK_ID, _MIN and _COUNT say; empty: all"),
                        &O::shard)),
        of_the_run(text(spec("until", Kind::text, "WHERE", run,
                             "loop: stop after the appearance loop and keep what it came to in OUT/skin.mixtures (or "
                             "--mixtures FILE), for shards and other jobs of the body; end: go on to the end",
                             names_of<Until>()),
                        &O::until)),
        of_the_run(number(
            spec("threads", Kind::number, "N", run, "threads; 0: one per core. The result does not depend on it"),
            &O::threads)),
        number(spec("seed", Kind::number, "N", run, "seed of what is random (error diffusion)"), &O::seed),
    };
}

}  // namespace

std::span<const OptionSpec> slice_option_table() {
    static const std::vector<OptionSpec> table = make_table();
    return table;
}

const OptionSpec* find_option(std::string_view key) {
    for (const OptionSpec& spec : slice_option_table())
        if (spec.key == key) return &spec;
    return nullptr;
}

std::vector<std::string> predict_choices() {
    std::vector<std::string> choices{std::string(predict_auto), std::string(predict_none)};
    for (const std::string& model : names_of<PredictionModel>()) choices.push_back(model);
    return choices;
}

}  // namespace voxtone::slicer

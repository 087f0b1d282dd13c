// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/table_of_colour.h"

#include <fmt/core.h>

#include "halftone/loop/appearance_loop.h"
#include "io/layers/stack_folder.h"
#include "slicer/options/auto_limits.h"
#include "slicer/options/table_parts.h"

namespace voxtone::slicer {

namespace {

using O = SliceOptions;
using Job = ResolvedJob;
using Names = OptionSpec::Names;
using Length = OptionSpec::Length;

std::vector<OptionSpec> quality_entries() {
    return {{.key = "quality",
             .metavar = "NAME",
             .group = "Colour",
             .help =
                 "draft: --iterations 0 --predict none, a look at size and colours in seconds; good: --iterations "
                 "auto --predict auto; best: --iterations long, which takes up to three times as long, and predicted "
                 "however large the print is (--predict transport: 3 s of two cores and 0.25 GB for each cm2 of "
                 "surface). Options that are said beside it win",
             .choices = {"draft", "good", "best"},
             .decides_scope = true,
             .idle = {[](const O& o, bool) {
                 return unless(shows_colours(o), "it is of the appearance loop, which only --show colour has");
             }},
             .presets = {{"draft", {{"iterations", "0"}, {"predict", "none"}}},
                         {"good", {{"iterations", "auto"}, {"predict", "auto"}}},
                         {"best", {{"iterations", "long"}, {"predict", "transport"}}}}}};
}

OptionSpec alpha_entry() {
    OptionSpec spec = choice(&O::alpha, at(&Job::colour, &ColourOptions::alpha),
                             {.key = "alpha",
                              .metavar = "MEANING",
                              .group = "Colour",
                              .help = "alpha of colours: laid over-white, or translucency after ISO 19307: 0 prints as "
                                      "clear resin (role T), 1 as opaque as the resins are, in shell and core",
                              .only_for = colour_show,
                              .idle = {[](const O& o, bool) {
                                  return unless(o.alpha == name_of(AlphaMeaning::over_white) || !o.cut_out,
                                                "--cut-out takes alpha for a shape: leave one of the two out");
                              }},
                              .rule = [](const O& o) {
                                  const bool plain =
                                      o.coat_mm == 0 && o.enclose_mm == 0 && o.view == name_of(PictureView::front);
                                  return unless(o.alpha == name_of(AlphaMeaning::over_white) || plain,
                                                "goes with no --coat, --enclose or --view through");
                              }});
    const auto of_colour = spec.resolve;
    spec.resolve = [of_colour](const O& o, Job& job) {
        of_colour(o, job);
        job.reading.keep_alpha = job.colour.alpha == AlphaMeaning::translucency;
    };
    return spec;
}

std::vector<OptionSpec> resins_entries() {
    const std::string group = "Colour";
    return {
        plain(&O::texture, at(&Job::texture),
              {.key = "texture",
               .metavar = "FILE",
               .group = group,
               .help = "picture for a mesh that has texture coordinates and no picture for them; those that the mesh "
                       "has stay; empty: none",
               .names = Names::input,
               .only_for = colour_show,
               .idle = {[](const O&, bool is_picture) {
                   return unless(!is_picture, "it is for meshes; a picture is its own texture");
               }}}),
        choice(&O::texture_filter, at(&Job::reading, &io::ReadOptions::texture_filter),
               {.key = "texture-filter",
                .metavar = "HOW",
                .group = group,
                .help = "between texels: as the model's file says (linear where it does not), nearest (the sharp edges "
                        "of pixel art) or linear",
                .only_for = colour_show}),
        plain(&O::resins, at(&Job::resins),
              {.key = "resins",
               .metavar = "SET|FILE",
               .group = group,
               .help = "resin set; see `voxtone list resins`; empty: the printer's default",
               .names = Names::input_or_known}),
        plain(&O::illuminant, at(&Job::illuminant),
              {.key = "illuminant",
               .metavar = "LAMP|FILE",
               .group = group,
               .help = fmt::format("{}, and are a guess without. Colours are asked for as D65 shows them, and printed "
                                   "to look so to an eye used to the lamp",
                                   illuminant_words),
               .names = Names::input_or_known,
               .only_for = colour_show}),
        plain(&O::load, at(&Job::load),
              {.key = "load",
               .metavar = "ROLES",
               .group = group,
               .help = "resins that are loaded, by role (C,M,Y,K,W); empty: the printer's default, and T where clear "
                       "resin is asked for"}),
        plain(&O::core, at(&Job::colour, &ColourOptions::core),
              {.key = "core",
               .metavar = "ROLE",
               .group = group,
               .help = "resin below the coloured shell",
               .only_for = colour_show}),
        plain(Length{&O::depth_mm}, at(&Job::colour, &ColourOptions::depth_mm),
              {.key = "depth",
               .group = group,
               .help = "colour depth: how far below the surface voxels carry colour",
               .only_for = colour_show,
               .rule =
                   [](const O& o) {
                       return unless(o.depth_mm > 0 && o.depth_mm <= 10, "must be above 0 and at most 10 mm");
                   }}),
        plain(Length{&O::coat_mm}, at(&Job::colour, &ColourOptions::coat_mm),
              {.key = "coat",
               .group = group,
               .help = "clear resin (role T) over the colours: of a model within its surface, which stays as large as "
                       "it is, of a picture on top of its slab; 0: none",
               .only_for = colour_show,
               .rule = [](const O& o) { return unless(o.coat_mm >= 0 && o.coat_mm <= 10, "must be 0 to 10 mm"); }}),
        plain(Length{&O::enclose_mm}, at(&Job::colour, &ColourOptions::enclose_mm),
              {.key = "enclose",
               .group = group,
               .help = "pictures: clear resin (role T) over and under the slab, so much on either side; 0: none",
               .only_for = colour_show,
               .idle = {[](const O&, bool is_picture) {
                   return unless(is_picture, "it is for pictures; --coat lays clear resin over the colours of a model");
               }},
               .rule =
                   [](const O& o) {
                       if (o.coat_mm > 0 && o.enclose_mm > 0)
                           return std::string_view("has a coat of its own: leave --coat or --enclose out");
                       return unless(o.enclose_mm >= 0 && o.enclose_mm <= 10, "must be 0 to 10 mm");
                   }}),
        alpha_entry(),
        choice(&O::screen, at(&Job::colour, &ColourOptions::screen),
               {.key = "screen",
                .metavar = "NAME",
                .group = group,
                .help = "halftone screen: blue-noise (position-addressed) or error-diffusion (three-dimensional)",
                .rule =
                    [](const O& o) {
                        return unless(shows_colours(o) || o.screen == name_of(ScreenKind::blue_noise),
                                      "what shows no colours is dithered by the screen blue-noise only");
                    }}),
        choice(&O::mixing, at(&Job::colour, &ColourOptions::mixing),
               {.key = "mixing",
                .metavar = "HOW",
                .group = group,
                .help = "what the separation takes a mixture to be: voxels of the printer's size, between which light "
                        "finds its way, or ideal (averaged)",
                .only_for = colour_show}),
        choice(
            &O::view, at(&Job::picture, &PictureOptions::view),
            {.key = "view",
             .metavar = "FROM",
             .group = group,
             .help = "pictures: seen by light that falls on them (front), or by that of a wide diffuse source behind "
                     "them (through: a lithophane), where white is what clear resin lets through; both: by day this "
                     "picture, "
                     "by light from behind that of --night. The last two want clear resin",
             .only_for = colour_show,
             .idle = {[](const O&, bool is_picture) {
                 return unless(is_picture, "light goes through the slabs of pictures; a mesh is seen from all sides");
             }},
             .rule =
                 [](const O& o) {
                     if (o.view != name_of(PictureView::both)) return std::string_view();
                     if (o.night.empty()) return std::string_view("wants a second picture: --night FILE");
                     return unless(o.coat_mm == 0 && o.enclose_mm == 0 && o.core == "W",
                                   "goes with no --coat, --enclose or --core: white lies between day and night");
                 }}),
        plain(&O::night, at(&Job::picture, &PictureOptions::night),
              {.key = "night",
               .metavar = "FILE",
               .group = group,
               .help = "with --view both: the picture that light from behind shows, of the same shape",
               .names = Names::input,
               .only_for = colour_show,
               .idle = {[](const O& o, bool) {
                   return unless(o.view == name_of(PictureView::both), "only --view both shows a second picture");
               }}}),
        {.key = "backing",
         .metavar = "SHEET",
         .group = group,
         .help = fmt::format("pictures: what lies under the slab, air between: {}", backing_words),
         .member = &O::backing,
         .names = Names::input_or_known,
         .idle = {[](const O&, bool is_picture) {
                      return unless(is_picture, "a sheet lies under pictures only; a mesh floats in light");
                  },
                  [](const O& o, bool) {
                      return unless(o.view != name_of(PictureView::through),
                                    "with --view through a source lies behind the picture, and no sheet");
                  }},
         .resolve = [](const O& o, Job& job) { job.picture.backing = parse_backing("backing", o.backing); }},
    };
}

std::vector<OptionSpec> loop_entries() {
    const std::string group = "Appearance loop";
    return {
        {.key = "iterations",
         .metavar = "N",
         .group = group,
         .help = fmt::format("how often the resins are rearranged after looking at the predicted print; 0: never; "
                             "auto: until it stops gaining, at most {}; long: the same, at most {}",
                             halftone::most_iterations, halftone::patient_iterations),
         .member = &O::iterations,
         .decides = Decides::bits_after_loop,
         .decides_scope = true,
         .idle = {[](const O& o, bool) {
             return unless(shows_colours(o) || parse_iterations(o.iterations) == 0, "it only goes with --show colour");
         }},
         .resolve =
             [](const O& o, Job& job) {
                 job.loop.iterations = parse_iterations(o.iterations);
                 job.loop.patient = o.iterations == patient_word;
             }},
        choice(&O::intent, at(&Job::loop, &JobLoopOptions::intent),
               {.key = "intent",
                .metavar = "NAME",
                .group = group,
                .help = "relative: the target's white is the white resin; absolute: it is a body that absorbs "
                        "nothing; contrast: relative, and where a limit is met the surroundings give way too, so that "
                        "local contrast is kept",
                .only_for = colour_show,
                .idle = {idle::without_loop}}),
        plain(Length{&O::viewing_distance_mm}, at(&Job::loop, &JobLoopOptions::viewing_distance_mm),
              {.key = "viewing-distance",
               .group = group,
               .help = "from where the print is looked at: what cannot be seen from there counts less",
               .only_for = colour_show,
               .idle = {idle::without_loop},
               .rule =
                   [](const O& o) {
                       return unless(o.viewing_distance_mm >= 10 && o.viewing_distance_mm <= 1e5,
                                     "must be 10 mm to 100 m");
                   }}),
        choice(&O::loop_model, at(&Job::loop, &JobLoopOptions::model),
               {.key = "loop-model",
                .metavar = "MODEL",
                .group = group,
                .help = "what predicts the print in the loop; monte-carlo is for slabs of a few mm",
                .only_for = colour_show,
                .idle = {idle::without_loop}}),
        choice(&O::loop_method, at(&Job::loop, &JobLoopOptions::method),
               {.key = "loop-method",
                .metavar = "NAME",
                .group = group,
                .help = "feedback: each place corrects itself; descent: feedback, then along the gradient of the "
                        "whole print, which is sharper and takes two to three times the time and 1.5 times the "
                        "memory; auto: descent for pictures and --intent contrast, up to 15 cm2 of coloured "
                        "surface, feedback otherwise",
                .only_for = colour_show,
                .idle = {idle::without_loop}}),
        plain(&O::resume, at(&Job::resume),
              {.key = "resume",
               .group = group,
               .help = "go on with the loop of an interrupted job in the same output folder; with fewer --iterations "
                       "than it has made it prints the best of them",
               .decides = Decides::this_run,
               .only_for = colour_show}),
        plain(&O::keep_loop, at(&Job::keep_loop),
              {.key = "keep-loop",
               .group = group,
               .help = "keep what the appearance loop came to in OUT/skin.mixtures beside the finished stack, for the "
                       "same job with another report, prediction, formats or layers",
               .decides = Decides::work,
               .only_for = colour_show,
               .idle = {idle::without_loop}}),
        {.key = "mixtures",
         .metavar = "FILE",
         .group = group,
         .help = "what the appearance loop came to, kept by --until loop: it is read and the loop not run; empty: "
                 "OUT/skin.mixtures, if it is there",
         .member = &O::mixtures,
         .names = Names::input,
         .decides = Decides::this_run,
         .only_for = colour_show,
         .idle = {idle::without_loop},
         .resolve =
             [](const O& o, Job& job) {
                 job.loop.mixtures_named = !o.mixtures.empty();
                 job.loop.mixtures = o.mixtures.empty() ? std::filesystem::path(o.out) / io::skin_name
                                                        : std::filesystem::path(o.mixtures);
             }},
    };
}

/// Somebody predicts the print for the report.
bool has_prediction(const SliceOptions& o) { return o.predict != predict_none && o.report; }

std::string_view why_no_prediction(const SliceOptions& o, bool) {
    if (!shows_colours(o)) return unless(o.predict == predict_none, "it only goes with --show colour");
    return unless(o.report || o.predict == predict_auto || o.predict == predict_none,
                  "it is for the report, which --no-report leaves out");
}

void resolve_prediction(const SliceOptions& o, ResolvedJob& job) {
    job.prediction.automatic = o.predict == predict_auto;
    job.prediction.model.reset();
    if (job.prediction.automatic || o.predict == predict_none) return;
    job.prediction.model = value_of<PredictionModel>(o.predict);
    if (!job.prediction.model) refuse_choice("predict", o.predict, predict_choices());
}

std::vector<OptionSpec> prediction_entries() {
    const std::string group = "Prediction";
    return {
        {.key = "predict",
         .metavar = "MODEL",
         .group = group,
         .help = fmt::format("what predicts the print for the report; none: the separation's own model, without "
                             "spreading light; auto: {} for up to {:g} cm2 of coloured surface, else none",
                             name_of(PredictionModel::transport), auto_prediction_cm2),
         .choices = predict_choices(),
         .member = &O::predict,
         .decides = Decides::looks,
         .decides_scope = true,
         .idle = {why_no_prediction},
         .resolve = resolve_prediction},
        plain(Length{&O::predict_cell_mm}, at(&Job::prediction, &JobPredictionOptions::cell_mm),
              {.key = "predict-cell",
               .group = group,
               .help = "cells that are predicted and seen as one; from twice the default on it is a quick look, "
                       "averaged over cells of the eye",
               .only_for = colour_show,
               .idle = {[](const O& o, bool) {
                   return unless(has_loop(o) || has_prediction(o), "there is neither a loop nor a prediction");
               }},
               .rule =
                   [](const O& o) {
                       return unless(o.predict_cell_mm >= 0.01 && o.predict_cell_mm <= 5, "must be 0.01 to 5 mm");
                   }}),
        plain(&O::verdict_good, at(&Job::verdict, &VerdictLimits::good),
              {.key = "verdict-good",
               .metavar = "DE",
               .group = group,
               .help = "the print looks as asked where the mean difference as seen from the viewing distance is not "
                       "above this, CIEDE2000; a contract proof may have 2.5 (ISO 12647-7)",
               .decides = Decides::looks,
               .rule = [](const O& o) { return unless(o.verdict_good > 0, "must be above 0"); }}),
        plain(&O::verdict_bad, at(&Job::verdict, &VerdictLimits::bad),
              {.key = "verdict-bad",
               .metavar = "DE",
               .group = group,
               .help = "and does not where it is above this: colours are taken for others; with --strict that is exit "
                       "code 6, and the stack is there",
               .decides = Decides::looks,
               .rule =
                   [](const O& o) {
                       return unless(o.verdict_bad >= o.verdict_good, "must not be below --verdict-good");
                   }}),
    };
}

}  // namespace

std::vector<OptionSpec> table_of_colour() {
    std::vector<OptionSpec> table;
    for (const std::vector<OptionSpec>& part :
         {quality_entries(), resins_entries(), loop_entries(), prediction_entries()})
        table.insert(table.end(), part.begin(), part.end());
    return table;
}

}  // namespace voxtone::slicer

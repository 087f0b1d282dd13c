// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/table_of_body.h"

#include "io/models/model_reader.h"
#include "slicer/options/table_of_shows.h"
#include "slicer/options/table_parts.h"

namespace voxtone::slicer {

namespace {

using O = SliceOptions;
using Job = ResolvedJob;
using Names = OptionSpec::Names;
using Length = OptionSpec::Length;

std::vector<io::LayerFormat> formats_of(const SliceOptions& o) {
    std::vector<io::LayerFormat> formats;
    for (const std::string& name : o.formats) formats.push_back(parse_choice<io::LayerFormat>("formats", name));
    return formats;
}

bool holds_gcvf(const std::vector<std::string>& formats) {
    return std::ranges::find(formats, name_of(io::LayerFormat::gcvf)) != formats.end();
}

std::vector<OptionSpec> files_entries() {
    const std::string group = "Input and output";
    return {
        {.key = "model",
         .positional = true,
         .metavar = "FILE",
         .group = group,
         .help = "textured mesh (OBJ, PLY, STL, glTF, GLB, 3MF, FBX, VRML, or a ZIP of one) or picture; several, or a "
                 "tray's plan (JSON, CSV), come in one print",
         .member = &O::model,
         .names = Names::input,
         .decides_scope = true,
         .rule =
             [](const O& o) {
                 if (is_show(o.model))
                     return std::string_view("is no file, but what --show says: a model or a picture stands here");
                 return unless(!o.model.empty(), "name a model or a picture");
             },
         .resolve =
             [](const O& o, Job& job) {
                 job.model = o.model;
                 job.kind = model_kind(o.model);
             }},
        plain(&O::out, at(&Job::out),
              {.key = "out",
               .letter = "o",
               .metavar = "FOLDER",
               .group = group,
               .help = "output folder; nothing is written outside it, but for --for-printer. x.gcvf: that file, all "
                       "else in the folder x",
               .names = Names::output,
               .decides = Decides::work,
               .rule = [](const O& o) { return unless(!o.out.empty(), "name the output folder: -o FOLDER"); }}),
        {.key = "formats",
         .metavar = "LIST",
         .group = group,
         .help =
             "what to write: png (RGBA stack for Voxel Print), gcvf, tiff or png1 (one per resin and layer; black is "
             "resin in the TIFF, white in the PNG), vdb; "
             "empty: the printer's default",
         .choices = names_of<io::LayerFormat>(),
         .member = &O::formats,
         .decides = Decides::bits_after_loop,
         .rule =
             [](const O& o) {
                 const auto named = [&](io::LayerFormat format) {
                     return std::ranges::find(o.formats, name_of(format)) != o.formats.end();
                 };
                 return unless(!named(io::LayerFormat::tiff) || !named(io::LayerFormat::png1),
                               "tiff and png1 do not go together: they lie in the same folders, and one is the other's "
                               "negative; name one of them");
             },
         .resolve = [](const O& o, Job& job) { job.formats = formats_of(o); }},
        {.key = "for-printer",
         .metavar = "FOLDER|FILE.zip|FILE.gcvf",
         .group = group,
         .help = "put what the printer's computer takes, and how to print it, here too: a folder, one ZIP file, or the "
                 "GCVF file alone; OUT/printer has it in any case",
         .member = &O::for_printer,
         .names = Names::output,
         .decides = Decides::this_run,
         .rule =
             [](const O& o) {
                 if (std::filesystem::path(o.for_printer).extension() == ".gcvf" && !holds_gcvf(o.formats))
                     return std::string_view("wants gcvf among the formats, which is what would be handed over");
                 return unless(
                     o.for_printer.empty() || (o.shard.empty() && o.until == name_of(Until::end)),
                     "there is no whole print to hand over yet; say it to `voxtone merge`, or to the job that "
                     "makes the layers");
             },
         .resolve = [](const O& o, Job& job) { job.for_printer = o.for_printer; }},
        plain(
            &O::overwrite, at(&Job::overwrite),
            {.key = "overwrite",
             .group = group,
             .help = "replace a stack that the folder holds, make the same one again; other things in the folder stay",
             .decides = Decides::this_run}),
        plain(&O::report, at(&Job::report),
              {.key = "report",
               .group = group,
               .help = "write report.html, target and predicted pictures",
               .decides = Decides::looks,
               .decides_scope = true}),
    };
}

std::vector<OptionSpec> size_entries() {
    const std::string group = "Placement";
    return {
        plain(&O::printer, at(&Job::printer),
              {.key = "printer",
               .metavar = "ID|FILE",
               .group = group,
               .help = "printer profile; see `voxtone list printers`",
               .names = Names::input_or_known}),
        {.key = "unit",
         .metavar = "UNIT",
         .group = group,
         .help = "unit of the model's numbers: um, mm, cm, m, in, ft, or auto (the file's own; mm where it has none)",
         .member = &O::unit,
         .idle = {[](const O&, bool is_picture) {
             return unless(!is_picture, "it is the unit of a mesh's numbers; a picture is as wide as --width says");
         }},
         .resolve = [](const O& o, Job& job) { job.placement.unit = parse_file_unit(o.unit); }},
        plain(Length{&O::size_mm}, at(&Job::placement, &PlacementOptions::size_mm),
              {.key = "size",
               .group = group,
               .help = "scale so that the largest extent is this, of a picture the longer of width and height; 0: "
                       "leave the size",
               .decides_scope = true,
               .idle = {[](const O& o, bool is_picture) {
                   return unless(!is_picture || !(o.width_mm > 0 || o.height_mm > 0 || o.dpi > 0),
                                 "--width, --height or --dpi decides how large the picture is; give one of them");
               }},
               .rule = [](const O& o) { return unless(o.size_mm >= 0, "must not be negative"); }}),
        plain(&O::scale, at(&Job::placement, &PlacementOptions::scale),
              {.key = "scale",
               .metavar = "FACTOR",
               .group = group,
               .help = "scale by this factor; does not go with --size",
               .idle = {[](const O& o, bool) {
                   return unless(!(o.size_mm > 0), "--size decides how large the model is; give one of them");
               }},
               .rule = [](const O& o) { return unless(o.scale > 0, "must be above 0"); }}),
        plain(Length{&O::width_mm}, at(&Job::picture, &PictureOptions::width_mm),
              {.key = "width",
               .group = group,
               .help = "pictures: width of the slab; 0: from the picture's own resolution",
               .idle = {idle::of_a_mesh},
               .rule = [](const O& o) { return unless(o.width_mm >= 0, "must not be negative"); }}),
        plain(Length{&O::height_mm}, at(&Job::picture, &PictureOptions::height_mm),
              {.key = "height",
               .group = group,
               .help = "pictures: the same by the height of the picture",
               .idle = {idle::of_a_mesh},
               .rule =
                   [](const O& o) {
                       if (o.height_mm > 0 && o.width_mm > 0)
                           return std::string_view("the picture keeps its shape: give --width or --height");
                       return unless(o.height_mm >= 0, "must not be negative");
                   }}),
        plain(&O::dpi, at(&Job::picture, &PictureOptions::dpi),
              {.key = "dpi",
               .metavar = "DPI",
               .group = group,
               .help = "pictures: the same by so many pixels an inch, whatever the file says; 0: as it says",
               .idle = {idle::of_a_mesh},
               .rule =
                   [](const O& o) {
                       if (o.dpi > 0 && (o.height_mm > 0 || o.width_mm > 0))
                           return std::string_view("--width or --height decides how large the picture is");
                       return unless(o.dpi >= 0 && o.dpi <= 1e5, "must be above 0 and at most 100000");
                   }}),
        plain(Length{&O::thickness_mm}, at(&Job::picture, &PictureOptions::thickness_mm),
              {.key = "thickness",
               .group = group,
               .help = "pictures: thickness of the slab",
               .idle = {[](const O&, bool is_picture) {
                   return unless(is_picture, "it is for pictures; open sheets of a mesh have a --sheet-thickness");
               }},
               .rule = [](const O& o) { return unless(o.thickness_mm > 0, "must be above 0"); }}),
        plain(&O::cut_out, at(&Job::picture, &PictureOptions::cut_out),
              {.key = "cut-out",
               .group = group,
               .help = "pictures: print what is opaque alone, cut to shape where alpha is a half; sizes are of that",
               .idle = {[](const O&, bool is_picture) {
                            return unless(is_picture, "it is for pictures; a model has a shape of its own");
                        },
                        [](const O& o, bool) { return unless(shows_colours(o), "it only goes with --show colour"); }}}),
    };
}

std::vector<OptionSpec> turn_entries() {
    const std::string group = "Placement";
    return {
        {.key = "rotate",
         .metavar = "AXES",
         .group = group,
         .help = "turn about the axes in this order, degrees, right-handed: x90 or z45,x-30",
         .member = &O::rotate,
         .resolve =
             [](const O& o, Job& job) {
                 job.placement.rotation = parse_rotation(o.rotate);
                 job.placement.rotation_text = o.rotate;
             }},
        plain(&O::flip_x, at(&Job::placement, &PlacementOptions::flip_x),
              {.key = "flip-x", .group = group, .help = "mirror the print along x (columns of the bitmaps)"}),
        plain(&O::flip_y, at(&Job::placement, &PlacementOptions::flip_y),
              {.key = "flip-y", .group = group, .help = "mirror the print along y (rows of the bitmaps)"}),
        plain(
            &O::swap_xy, at(&Job::placement, &PlacementOptions::swap_xy),
            {.key = "swap-xy", .group = group, .help = "exchange x and y of the model (mirrors it; before the flips)"}),
        {.key = "layers",
         .metavar = "A-B",
         .group = group,
         .help = "only these layers, counted from 0 at the bottom; empty: all",
         .member = &O::layers,
         .decides = Decides::bits_after_loop,
         .resolve = [](const O& o, Job& job) { job.layers = parse_layer_range(o.layers); }},
    };
}

std::vector<OptionSpec> mesh_entries() {
    const std::string group = "Body";
    return {
        choice(
            &O::repair, at(&Job::repair),
            {.key = "repair",
             .metavar = "HOW",
             .group = group,
             .help = "broken meshes: off (refuse), auto (close holes; wrap what stays open), fill (holes of any size, "
                     "too) or wrap (always)"}),
        plain(Length{&O::sheet_thickness_mm}, at(&Job::sheet_mm),
              {.key = "sheet-thickness",
               .group = group,
               .help = "of open sheets (a terrain without a base), behind their faces; 0: one voxel",
               .idle = {[](const O&, bool is_picture) {
                   return unless(!is_picture, "it is for meshes; a picture's slab has a --thickness");
               }},
               .rule = [](const O& o) { return unless(o.sheet_thickness_mm >= 0, "must be above 0"); }}),
        choice(&O::cavities, at(&Job::cavities),
               {.key = "cavities",
                .metavar = "HOW",
                .group = group,
                .help = "voids that cannot be reached from outside: auto (fill those behind walls thinner than the "
                        "coloured shell), keep or fill (all, also those with openings below 3.5 mm)"}),
        plain(&O::keep_thin, at(&Job::keep_thin),
              {.key = "keep-thin",
               .group = group,
               .help = "features thinner than a voxel get one voxel instead of vanishing"}),
    };
}

}  // namespace

std::vector<OptionSpec> table_of_body() {
    std::vector<OptionSpec> table;
    for (const std::vector<OptionSpec>& part : {files_entries(), size_entries(), turn_entries(), mesh_entries()})
        table.insert(table.end(), part.begin(), part.end());
    return table;
}

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/jobs/layered_options.h"

#include <iterator>
#include <memory>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "base/error.h"
#include "base/units.h"
#include "slicer/options/option_table.h"
#include "slicer/options/option_values.h"

namespace voxtone::scattering {

namespace {

using slicer::OptionSpec;
using slicer::parse_list;
using slicer::unless;
using O = slicer::SliceOptions;
using Kind = OptionSpec::Kind;
using Names = OptionSpec::Names;
using Other = OptionSpec::Other;

std::string said(const O& o, std::string_view key) { return slicer::find_option(key)->get(o); }
double number_in(const O& o, std::string_view key) {
    const std::string text = said(o, key);
    return text.ends_with("mm") ? parse_length_mm(text, key) : slicer::parse_number<double>(key, text);
}
std::uint32_t count_in(const O& o, std::string_view key) {
    return slicer::parse_number<std::uint32_t>(key, said(o, key));
}

/// A number or a length that lies from `least` to `most`.
OptionSpec bounded(double least, double most, std::string_view rule, OptionSpec spec) {
    spec.rule = [=, key = spec.key](const O& o) {
        const double value = number_in(o, key);
        return unless(value >= least && value <= most, rule);
    };
    return spec;
}
constexpr double above_zero = 1e-300;

std::vector<OptionSpec> map_entries() {
    return {
        {.key = "profiles",
         .metavar = "MAP",
         .help = "map of wanted scattering profiles (voxtone-profile-map)",
         .member = Other{},
         .names = Names::input,
         .rule =
             [](const O& o) {
                 return unless(!said(o, "profiles").empty(),
                               "--show layered-profile needs a map of profiles (voxtone-profile-map)");
             }},
        {.key = "profile-placement",
         .metavar = "HOW",
         .help = "where on a mesh the map lies: uv (texture coordinates; it repeats) or box (projected along the main "
                 "axis of the normal, in mm; mirrored beyond its edges); on a picture's slab it lies on the picture",
         .choices = names_of<ProfilePlacement>(),
         .member = Other{Kind::text, "uv"},
         .idle = {[](const O&, bool is_picture) {
             return unless(!is_picture, "on a picture's slab the map lies on the picture");
         }}},
    };
}

std::vector<OptionSpec> search_entries() {
    return {
        bounded(above_zero, 50, "must be above 0 and at most 50 mm",
                {.key = "laminate-thickness",
                 .metavar = "LENGTH",
                 .help = "most thickness of a laminate",
                 .member = Other{Kind::length, "5mm"}}),
        bounded(1, 4096, "must be 1 to 4096",
                {.key = "laminate-steps",
                 .metavar = "N",
                 .help = "the search cuts that thickness into so many steps",
                 .member = Other{Kind::number, "64", true}}),
        bounded(1, 16, "must be 1 to 16",
                {.key = "laminate-blocks",
                 .metavar = "N",
                 .help = "and makes laminates of so many blocks, of 1, 2, 4, ... steps, at most",
                 .member = Other{Kind::number, "6", true}}),
        {.key = "laminate-rounds",
         .metavar = "N",
         .help =
             "rounds in which a laminate is searched, computed in all directions and corrected for what the layered "
             "model got wrong; the best is kept; 0: by the model alone; a round takes about a second of one core for "
             "each cluster; auto: 1 for resins, 0 for measured materials",
         .member = Other{Kind::text, "auto"},
         .rule =
             [](const O& o) {
                 return unless(parse_laminate_rounds(said(o, "laminate-rounds")).value_or(0) == 0 ||
                                   said(o, "laminate-materials").empty(),
                               "measured materials have no medium that light could be computed in: 0 or auto");
             }},
        {.key = "laminate-materials",
         .metavar = "ROLE=FILE",
         .help = "measured profiles (voxtone-profile) of the loaded resins in the place of computed ones: "
                 "W=white.json,K=black.json; all or none",
         .member = Other{Kind::list},
         .names = Names::inputs_by_role},
        bounded(above_zero, 1e6, "must be above 0 and at most 1e6",
                {.key = "dc-weight",
                 .metavar = "W",
                 .help = "weight of the total reflectance against the profile's shape",
                 .member = Other{Kind::number, "1"}}),
    };
}

std::vector<OptionSpec> print_entries() {
    return {
        {.key = "clear-top",
         .metavar = "ROLE=LENGTH",
         .help = "this resin stays that far below the surface, such as T=0.2mm; a list",
         .member = Other{Kind::list}},
        {.key = "base",
         .metavar = "ROLE",
         .help = "resin below the laminates, taken to be deep",
         .member = Other{Kind::text, "K"}},
        bounded(0, 100, "must be 0 to 100 mm",
                {.key = "layer-smoothing",
                 .metavar = "LENGTH",
                 .help = "blur of the layers' thicknesses along the surface, standard deviation",
                 .member = Other{Kind::length, "0mm"}}),
        {.key = "surfaces",
         .help = "also write a closed mesh of each resin to OUT/surfaces, for printers fed with meshes",
         .member = Other{Kind::flag, "false"},
         .decides_scope = true},
        bounded(0.01, 5, "must be 0.01 to 5 mm",
                {.key = "surface-cell",
                 .metavar = "LENGTH",
                 .help = "cells that these meshes are made of; thinner layers have holes",
                 .member = Other{Kind::length, "0.1mm"},
                 .idle = {[](const O& o, bool) {
                     return unless(said(o, "surfaces") == "true", "it is for the meshes of --surfaces");
                 }}}),
    };
}

std::shared_ptr<const slicer::OtherOptions> resolve_layered(const O& o) {
    auto layered = std::make_shared<LayeredOptions>();
    layered->profiles = said(o, "profiles");
    layered->placement = slicer::parse_choice<ProfilePlacement>("profile-placement", said(o, "profile-placement"));
    layered->base = said(o, "base");
    layered->thickness_mm = number_in(o, "laminate-thickness");
    layered->steps = count_in(o, "laminate-steps");
    layered->blocks = count_in(o, "laminate-blocks");
    layered->rounds = parse_laminate_rounds(said(o, "laminate-rounds"));
    layered->materials = parse_laminate_materials(parse_list(said(o, "laminate-materials")));
    layered->dc_weight = number_in(o, "dc-weight");
    layered->clear_top = parse_clear_top(parse_list(said(o, "clear-top")));
    layered->smoothing_mm = number_in(o, "layer-smoothing");
    layered->surfaces = said(o, "surfaces") == "true";
    layered->surface_cell_mm = number_in(o, "surface-cell");
    return layered;
}

}  // namespace

std::optional<int> parse_laminate_rounds(const std::string& text) {
    return slicer::parse_count_or_auto("laminate-rounds", text, 20);
}

std::vector<LaminateMaterialFile> parse_laminate_materials(const std::vector<std::string>& entries) {
    std::vector<LaminateMaterialFile> parsed;
    for (const std::string& entry : entries) {
        const std::size_t equals = entry.find('=');
        if (equals == 0 || equals == std::string::npos || equals + 1 == entry.size())
            throw UsageError(fmt::format("--laminate-materials {}: write ROLE=FILE, such as W=white.json", entry));
        parsed.push_back({entry.substr(0, equals), entry.substr(equals + 1)});
        for (std::size_t i = 0; i + 1 < parsed.size(); ++i)
            if (parsed[i].role == parsed.back().role)
                throw UsageError(fmt::format("--laminate-materials {}: {} is named twice", entry, parsed.back().role));
    }
    return parsed;
}

std::vector<ClearTop> parse_clear_top(const std::vector<std::string>& entries) {
    std::vector<ClearTop> parsed;
    for (const std::string& entry : entries) {
        const std::size_t equals = entry.find('=');
        if (equals == 0 || equals == std::string::npos)
            throw UsageError(fmt::format("--clear-top {}: write ROLE=LENGTH, such as T=0.2mm", entry));
        parsed.push_back({entry.substr(0, equals), parse_length_mm(entry.substr(equals + 1), "--clear-top")});
        if (!(parsed.back().mm >= 0)) throw UsageError(fmt::format("--clear-top {}: must be 0 or more", entry));
    }
    return parsed;
}

slicer::OtherShow layered_show_options() {
    std::vector<OptionSpec> options;
    for (std::vector<OptionSpec> part : {map_entries(), search_entries(), print_entries()})
        options.insert(options.end(), std::make_move_iterator(part.begin()), std::make_move_iterator(part.end()));
    return {layered_show, "how light spreads, by layers of resin under each point (docs/layered-prints.md)",
            "Layered profiles", std::move(options), resolve_layered};
}

const LayeredOptions* layered_options(const slicer::ResolvedJob& job) {
    return dynamic_cast<const LayeredOptions*>(job.other.get());
}

}  // namespace voxtone::scattering

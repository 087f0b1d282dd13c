// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/table_of_layers.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "slicer/options/table_parts.h"

namespace voxtone::slicer {

namespace {

using O = SliceOptions;
using Job = ResolvedJob;
using Names = OptionSpec::Names;
using Length = OptionSpec::Length;

constexpr std::string_view only_layered = "only goes with --show layered-profile";
constexpr const char* heading = "Layered profiles";

/// For who writes options in code, too: without layers such a file is not looked at, which nobody would notice.
std::string_view idle_without_layers(const SliceOptions& o, bool) { return unless(is_layered(o), only_layered); }

/// Of a print of layers; others have no such value.
template <class Resolve>
auto in_layers(Resolve resolve) {
    return [resolve](const SliceOptions& o, ResolvedJob& job) {
        if (job.layered) resolve(o, *job.layered);
    };
}

/// A value that only prints of layers have, as it is.
template <class Member, class Value>
OptionSpec layered_value(Member member, Value LayeredOptions::*value, OptionSpec spec) {
    const auto place = [value](ResolvedJob& job) -> decltype(auto) { return ((*job.layered).*value); };
    spec = plain(member, place, std::move(spec));
    spec.group = heading;
    spec.only_for = Show::layered_profile;
    return spec;
}

std::vector<OptionSpec> map_entries() {
    return {
        // First: it makes the place of the others' values.
        {.key = "show",
         .metavar = "NAME",
         .group = heading,
         .help = "what the surface is to show: colour, or layered-profile: how light spreads, by layers of resin under "
                 "each point (docs/layered-prints.md)",
         .choices = names_of<Show>(),
         .member = &O::show,
         .decides_scope = true,
         .resolve =
             [](const O& o, Job& job) {
                 if (parse_choice<Show>("show", o.show) == Show::colour) return;
                 job.layered.emplace();
                 job.loop.iterations = 0;  // it is a loop of colours
             }},
        {.key = "profiles",
         .metavar = "MAP",
         .group = heading,
         .help = "map of wanted scattering profiles (voxtone-profile-map)",
         .member = &O::profiles,
         .names = Names::input,
         .idle = {idle_without_layers},
         .rule =
             [](const O& o) {
                 if (!is_layered(o)) return unless(o.profiles.empty(), only_layered);
                 return unless(!o.profiles.empty(),
                               "--show layered-profile needs a map of profiles (voxtone-profile-map)");
             },
         .resolve = in_layers([](const O& o, LayeredOptions& layered) { layered.profiles = o.profiles; })},
        {.key = "profile-placement",
         .metavar = "HOW",
         .group = heading,
         .help = "where on a mesh the map lies: uv (texture coordinates; it repeats) or box (projected along the main "
                 "axis of the normal, in mm; mirrored beyond its edges); on a picture's slab it lies on the picture",
         .choices = names_of<ProfilePlacement>(),
         .member = &O::profile_placement,
         .only_for = Show::layered_profile,
         .idle = {[](const O&, bool is_picture) {
             return unless(!is_picture, "on a picture's slab the map lies on the picture");
         }},
         .resolve = in_layers([](const O& o, LayeredOptions& layered) {
             layered.placement = parse_choice<ProfilePlacement>("profile-placement", o.profile_placement);
         })},
    };
}

std::vector<OptionSpec> search_entries() {
    return {
        layered_value(Length{&O::laminate_thickness_mm}, &LayeredOptions::thickness_mm,
                      {.key = "laminate-thickness",
                       .help = "most thickness of a laminate",
                       .rule =
                           [](const O& o) {
                               return unless(o.laminate_thickness_mm > 0 && o.laminate_thickness_mm <= 50,
                                             "must be above 0 and at most 50 mm");
                           }}),
        layered_value(&O::laminate_steps, &LayeredOptions::steps,
                      {.key = "laminate-steps",
                       .metavar = "N",
                       .help = "the search cuts that thickness into so many steps",
                       .rule =
                           [](const O& o) {
                               return unless(o.laminate_steps >= 1 && o.laminate_steps <= 4096, "must be 1 to 4096");
                           }}),
        layered_value(&O::laminate_blocks, &LayeredOptions::blocks,
                      {.key = "laminate-blocks",
                       .metavar = "N",
                       .help = "and makes laminates of so many blocks, of 1, 2, 4, ... steps, at most",
                       .rule =
                           [](const O& o) {
                               return unless(o.laminate_blocks >= 1 && o.laminate_blocks <= 16, "must be 1 to 16");
                           }}),
        {.key = "laminate-rounds",
         .metavar = "N",
         .group = heading,
         .help =
             "rounds in which a laminate is searched, computed in all directions and corrected for what the layered "
             "model got wrong; the best is kept; 0: by the model alone; a round takes about a second of one core for "
             "each cluster; auto: 1 for resins, 0 for measured materials",
         .member = &O::laminate_rounds,
         .only_for = Show::layered_profile,
         .rule =
             [](const O& o) {
                 return unless(
                     parse_laminate_rounds(o.laminate_rounds).value_or(0) == 0 || o.laminate_materials.empty(),
                     "measured materials have no medium that light could be computed in: 0 or auto");
             },
         .resolve = in_layers(
             [](const O& o, LayeredOptions& layered) { layered.rounds = parse_laminate_rounds(o.laminate_rounds); })},
        {.key = "laminate-materials",
         .metavar = "ROLE=FILE",
         .group = heading,
         .help = "measured profiles (voxtone-profile) of the loaded resins in the place of computed ones: "
                 "W=white.json,K=black.json; all or none",
         .member = &O::laminate_materials,
         .names = Names::inputs_by_role,
         .idle = {idle_without_layers},
         .rule = [](const O& o) { return unless(is_layered(o) || o.laminate_materials.empty(), only_layered); },
         .resolve = in_layers([](const O& o, LayeredOptions& layered) {
             layered.materials = parse_laminate_materials(o.laminate_materials);
         })},
        layered_value(&O::dc_weight, &LayeredOptions::dc_weight,
                      {.key = "dc-weight",
                       .metavar = "W",
                       .help = "weight of the total reflectance against the profile's shape",
                       .rule =
                           [](const O& o) {
                               return unless(o.dc_weight > 0 && o.dc_weight <= 1e6, "must be above 0 and at most 1e6");
                           }}),
    };
}

std::vector<OptionSpec> print_entries() {
    return {
        {.key = "clear-top",
         .metavar = "ROLE=LENGTH",
         .group = heading,
         .help = "this resin stays that far below the surface, such as T=0.2mm; a list",
         .member = &O::clear_top,
         .only_for = Show::layered_profile,
         .resolve =
             in_layers([](const O& o, LayeredOptions& layered) { layered.clear_top = parse_clear_top(o.clear_top); })},
        layered_value(&O::base, &LayeredOptions::base,
                      {.key = "base", .metavar = "ROLE", .help = "resin below the laminates, taken to be deep"}),
        layered_value(Length{&O::layer_smoothing_mm}, &LayeredOptions::smoothing_mm,
                      {.key = "layer-smoothing",
                       .help = "blur of the layers' thicknesses along the surface, standard deviation",
                       .rule =
                           [](const O& o) {
                               return unless(o.layer_smoothing_mm >= 0 && o.layer_smoothing_mm <= 100,
                                             "must be 0 to 100 mm");
                           }}),
        {.key = "surfaces",
         .group = heading,
         .help = "also write a closed mesh of each resin to OUT/surfaces, for printers fed with meshes",
         .member = &O::surfaces,
         .decides_scope = true,
         .idle = {idle_without_layers},
         .rule = [](const O& o) { return unless(is_layered(o) || !o.surfaces, only_layered); },
         .resolve = in_layers([](const O& o, LayeredOptions& layered) { layered.surfaces = o.surfaces; })},
        layered_value(
            Length{&O::surface_cell_mm}, &LayeredOptions::surface_cell_mm,
            {.key = "surface-cell",
             .help = "cells that these meshes are made of; thinner layers have holes",
             .idle = {[](const O& o, bool) { return unless(o.surfaces, "it is for the meshes of --surfaces"); }},
             .rule =
                 [](const O& o) {
                     return unless(o.surface_cell_mm >= 0.01 && o.surface_cell_mm <= 5, "must be 0.01 to 5 mm");
                 }}),
    };
}

}  // namespace

std::vector<OptionSpec> table_of_layers() {
    std::vector<OptionSpec> table;
    for (const std::vector<OptionSpec>& part : {map_entries(), search_entries(), print_entries()})
        table.insert(table.end(), part.begin(), part.end());
    return table;
}

}  // namespace voxtone::slicer

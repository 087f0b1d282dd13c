// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/job_colour.h"

#include <algorithm>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "io/profiles/lamp_file.h"
#include "io/profiles/resin_family.h"
#include "io/profiles/resin_file.h"
#include "slicer/part/backing_sheet.h"
#include "slicer/part/phase.h"
#include "slicer/surface/surface_colour.h"

namespace voxtone::slicer {

namespace {

std::vector<std::string> roles_to_load(const ResolvedJob& job, const PrinterProfile& printer,
                                       const optics::ResinSet& set) {
    if (!job.load.empty()) return job.load;
    std::vector<std::string> roles;
    for (const std::string& role : printer.default_roles)
        if (set.find(role) >= 0) roles.push_back(role);
    // A set with roles of its own: take what it has, as far as the printer carries it.
    if (roles.empty())
        for (const optics::Resin& resin : set.resins)
            if (static_cast<int>(roles.size()) < printer.max_resins) roles.push_back(resin.role);
    // Clear resin takes a slot that is free.
    if (wants_clear(job) && set.find("T") >= 0 && std::ranges::find(roles, "T") == roles.end() &&
        static_cast<int>(roles.size()) < most_resins(printer))
        roles.push_back("T");
    return roles;
}

/// A set of the same cartridges with clear resin; empty where none comes with the program.
std::string clear_twin(const std::string& set) {
    const std::string family = io::resin_family(set);
    for (const std::string& name : io::known_resin_sets())
        if (io::resin_family(name) == family && io::find_resin_set(name).find("T") >= 0) return name;
    return {};
}

/// Throws InputError where clear resin is wanted and not loaded.
void check_clear(const ResolvedJob& job, const PrinterProfile& printer, const optics::ResinSet& all,
                 std::vector<std::string> roles) {
    if (!wants_clear(job) || std::ranges::find(roles, "T") != roles.end()) return;
    const ColourOptions& colour = job.colour;
    const std::string said = job.picture.view != PictureView::front
                                 ? fmt::format("--view {}", name_of(job.picture.view))
                             : colour.coat_mm > 0                         ? fmt::format("--coat {:g}mm", colour.coat_mm)
                             : colour.alpha == AlphaMeaning::translucency ? std::string("--alpha translucency")
                             : colour.enclose_mm > 0 ? fmt::format("--enclose {:g}mm", colour.enclose_mm)
                                                     : std::string("--core T");
    std::string remedy;
    if (all.find("T") < 0) {
        const std::string twin = clear_twin(job.resins.empty() ? printer.default_resins : job.resins);
        remedy = fmt::format("--resins {} ", twin.empty() ? "vero-opaque-clear" : twin);
    }
    // In the place of one that is least missed, where there is no slot for one more.
    if (static_cast<int>(roles.size()) >= most_resins(printer)) std::erase(roles, std::string("K"));
    throw InputError(fmt::format("{} takes clear resin (role T), and none is loaded; give {}--load {},T", said, remedy,
                                 fmt::join(roles, ",")));
}

/// Throws InputError where nothing that the picture may hold lets light through.
void check_lets_light_through(const ColourOptions& options, const optics::ShellAppearance& appearance) {
    const optics::ShellGeometry& geometry = appearance.geometry();
    if (!geometry.from_behind) return;
    // A hundredth of a lamp behind the print is as dark as what its black leaves (docs/backlit.md).
    constexpr double least = 0.01;
    double most = 0;
    std::vector<double> one(appearance.resins(), 0.0);
    for (double& share : one) {
        share = 1;
        for (const double through : appearance.appearance(one)) most = std::max(most, through);
        share = 0;
    }
    if (most >= least) return;
    throw InputError(fmt::format(
        "--view through: {:.3g} mm of {} below the colours let {:.2g} % of the light through at the most, so that the "
        "picture would be black; give --core T, or a smaller --thickness",
        geometry.core_mm, options.core, 100 * most));
}

}  // namespace

bool wants_clear(const ResolvedJob& job) {
    const ColourOptions& colour = job.colour;
    return job.shows_colours() && (colour.core == "T" || colour.alpha == AlphaMeaning::translucency ||
                                   colour.clear_over_mm() > 0 || job.picture.view != PictureView::front);
}

std::string usual_resins(const ResolvedJob& job, const PrinterProfile& printer) {
    if (wants_clear(job) && io::find_resin_set(printer.default_resins).find("T") < 0)
        if (std::string twin = clear_twin(printer.default_resins); !twin.empty()) return twin;
    return printer.default_resins;
}

optics::ResinSet all_resins(const ResolvedJob& job, const PrinterProfile& printer) {
    return io::seen_under(io::find_resin_set(job.resins.empty() ? printer.default_resins : job.resins), job.illuminant);
}

int most_resins(const PrinterProfile& printer) { return std::min(printer.max_resins, halftone::max_resins); }

LoadedResins load_roles(const ResolvedJob& job, const PrinterProfile& printer, const optics::ResinSet& all,
                        std::vector<std::string> roles) {
    LoadedResins loaded;
    if (static_cast<int>(roles.size()) > most_resins(printer))
        throw InputError(fmt::format("--load {}: {} resins, but {} carries {} at once; leave some out",
                                     fmt::join(roles, ","), roles.size(), printer.id, most_resins(printer)));
    loaded.set = all.subset(roles);
    loaded.spread_mm = printer.sliced_spread_mm();
    check_clear(job, printer, all, roles);
    for (std::size_t r = 0; r < roles.size(); ++r) roles[r] = loaded.set.resins[r].role;
    loaded.core = loaded.set.find(job.core());
    if (loaded.core < 0)
        throw InputError(fmt::format("--{} {}: no such resin is loaded; loaded are {}", job.core_option(), job.core(),
                                     fmt::join(roles, ", ")));
    const std::vector<io::Rgb> colours = printer.display_colours(roles);
    for (std::size_t r = 0; r < roles.size(); ++r) {
        io::StackResin entry;
        const auto known = printer.material_names.find(roles[r]);
        entry.name = known != printer.material_names.end() ? known->second : loaded.set.resins[r].name;
        entry.role = roles[r];
        entry.rgb = colours[r];
        loaded.entries.push_back(std::move(entry));
    }
    return loaded;
}

LoadedResins load_resins(const ResolvedJob& job, const PrinterProfile& printer) {
    const optics::ResinSet all = all_resins(job, printer);
    return load_roles(job, printer, all, roles_to_load(job, printer, all));
}

std::optional<SlabUnderColour> slab_under_colour(const ResolvedJob& job, const JobBody& body) {
    if (!body.is_picture) return std::nullopt;
    const double clear_mm = job.colour.clear_over_mm() + job.colour.enclose_mm;
    const Eigen::Vector3d& mm = body.placement.extent_mm;
    return SlabUnderColour{mm.z() - clear_mm, job.picture.backing, job.picture.is_lit_from_behind(), {mm.x(), mm.y()}};
}

double looked_through_mm(const ResolvedJob& job) {
    const ColourOptions& colour = job.colour;
    // Clear resin lies all below an enclosed picture, and a night's colours on the lower face: to its lower face, and
    // what rounding of voxels adds to that.
    if (job.is_picture() && (colour.enclose_mm > 0 || job.picture.has_night()))
        return printed_mm(job.picture, colour) + 1;
    return colour.depth_mm + colour.clear_over_mm();
}

double looked_through_mm(const ResolvedJob& job, const JobBody& body) {
    if (!has_alpha(body.model.mesh)) return looked_through_mm(job);
    const Eigen::Vector3d& mm = body.placement.extent_mm;
    return std::max(looked_through_mm(job), (body.is_picture ? mm.z() : mm.minCoeff() / 2) + 1);
}

optics::ShellGeometry shell_geometry(const ColourOptions& options, const LoadedResins& resins,
                                     const Eigen::Vector3d& pitch_mm, const std::optional<SlabUnderColour>& slab) {
    optics::ShellGeometry geometry;
    geometry.shell_mm = options.depth_mm;
    if (options.mixing == Mixing::voxels) geometry.pitch_mm = {pitch_mm.x(), pitch_mm.y(), pitch_mm.z()};
    geometry.core_resin = resins.core;
    geometry.white_resin = resins.set.find("W");  // -1, the core, where no white is loaded
    geometry.seen = optics::SeenFrom::all_sides;
    geometry.over_mm = options.clear_over_mm();
    if (geometry.over_mm > 0) geometry.clear_resin = resins.set.find("T");
    if (!slab) return geometry;
    geometry.under_mm = options.enclose_mm;
    geometry.seen = optics::SeenFrom::above;
    geometry.shell_mm = std::min(options.depth_mm, slab->thickness_mm);
    // A slab that is colour all through has no core; the model wants one: a nanometre of it is nothing to light.
    constexpr double no_core_mm = 1e-6;
    geometry.core_mm = std::max(slab->thickness_mm - geometry.shell_mm, no_core_mm);
    geometry.backing = slab->backing.kind;
    if (const auto sheet = sheet_under(slab->backing, slab->size_mm, resins.set.channels))
        for (std::size_t c = 0; c < sheet->channels; ++c) geometry.sheet.push_back(sheet->mean(c));
    geometry.from_behind = slab->from_behind;
    if (geometry.from_behind) geometry.white_resin = resins.set.find("T");
    return geometry;
}

std::unique_ptr<const JobColour> prepare_colour(const ColourOptions& options, const LoadedResins& resins,
                                                const Eigen::Vector3d& pitch_mm,
                                                const std::optional<SlabUnderColour>& slab, Progress& progress) {
    progress.begin_stage(name_of(Phase::separate), 0);
    const optics::ShellGeometry geometry = shell_geometry(options, resins, pitch_mm, slab);
    auto colour = std::make_unique<const JobColour>(resins.set, geometry);
    check_lets_light_through(options, colour->appearance);
    progress.end_stage();
    return colour;
}

std::unique_ptr<const halftone::MinimalDepthSeparation> prepare_recipes(const optics::ShellAppearance& appearance,
                                                                        const halftone::SkinLayers& layers) {
    halftone::SeparationOptions separation;
    separation.channels = appearance.set().channels;
    constexpr int nodes = 33;
    separation.nodes = nodes;
    return std::make_unique<const halftone::MinimalDepthSeparation>(appearance, layers, separation);
}

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/prepare/opened_job.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "halftone/separation/invert_appearance.h"
#include "io/profiles/resin_family.h"
#include "io/profiles/resin_file.h"
#include "slicer/options/resolve_job.h"
#include "slicer/prepare/layers_check.h"
#include "slicer/printer/picture_slab.h"

namespace voxtone::slicer {

namespace {

void take_width(ResolvedJob& job, const io::ProfileMap& map) {
    if (!job.is_picture || is_sized(job.picture)) return;
    job.picture.width_mm = job.raw.width_mm = map.width_mm;
}

/// How thick a picture's slab is, is known without the picture; which way it is turned then, not here.
void check_thickness(const ResolvedJob& job, const PrinterProfile& printer) {
    if (!job.is_picture || !job.placement.rotation.isIdentity(0)) return;
    const Eigen::Vector3d slab_mm(1, 1, job.picture.thickness_mm);
    check_layer_count(grid_around(Eigen::Vector3d::Zero(), slab_mm, printer.sliced_pitch_mm()).size[2], printer,
                      "thicker (--thickness)");
}

/// The printer's; those of published profiles where a map has other channels than these.
std::string usual_resins(const OpenedJob& job) {
    const std::string& of_printer = job.printer.default_resins;
    const bool by_channel = job.map && job.options.layered->materials.empty();
    if (by_channel && io::find_resin_set(of_printer).channels != job.map->channels) return optics::vero_opaque().name;
    return of_printer;
}

/// Marks that are printed by a resin alone look as it does in the shell.
void colour_marks_by_resin(OpenedJob& job) {
    std::optional<optics::ShellAppearance> appearance;
    for (MarkOptions& mark : job.options.marks) {
        if (mark.resin.empty()) continue;
        const int resin = job.resins.set.find(mark.resin);
        if (resin < 0) {
            std::vector<std::string> roles;
            for (const io::StackResin& entry : job.resins.entries) roles.push_back(entry.role);
            throw InputError(fmt::format("{}: resin={} is not loaded; loaded are {} (--load)", mark.said, mark.resin,
                                         fmt::join(roles, ", ")));
        }
        if (!appearance)
            appearance.emplace(job.resins.set, shell_geometry(job.options.colour, job.resins,
                                                              job.printer.sliced_pitch_mm(), std::nullopt));
        halftone::SeparationOptions options;
        options.channels = job.resins.set.channels;
        std::vector<double> pure(job.resins.set.resins.size());
        pure[static_cast<std::size_t>(resin)] = 1;
        mark.ink_rgb =
            halftone::AppearanceColour(*appearance, options.channels).rgb(pure).cast<float>().cwiseMax(0).cwiseMin(1);
    }
}

}  // namespace

OpenedJob open_job(const SliceOptions& asked) {
    OpenedJob job{resolve(asked), {}, {}, std::nullopt, {}};
    check_model(job.options);
    if (job.options.layered) {
        job.map = io::read_profile_map(job.options.layered->profiles);
        take_width(job.options, *job.map);
    }
    job.printer = find_printer(job.options.printer);
    if (job.options.resins.empty()) job.options.resins = job.options.raw.resins = usual_resins(job);
    job.printer.load(job.options.resins, io::resin_family(job.options.resins));
    job.resins = load_resins(job.options, job.printer);
    check_thickness(job.options, job.printer);
    if (job.map) check_layers(*job.options.layered, *job.map, job.resins);
    colour_marks_by_resin(job);
    return job;
}

void OpenedJob::load(const std::vector<std::string>& roles) {
    options.load = roles;
    resins = load_resins(options, printer);
    colour_marks_by_resin(*this);
}

std::vector<io::Rgb> OpenedJob::palette() const {
    std::vector<io::Rgb> palette{printer.background_rgb};
    for (const io::StackResin& resin : resins.entries) palette.push_back(resin.rgb);
    return palette;
}

io::StackOutputs OpenedJob::outputs() const {
    io::StackOutputs outputs = io::outputs_for(options.formats.empty() ? printer.formats : options.formats);
    outputs.printer_folder = true;
    return outputs;
}

io::StackDescription OpenedJob::describe(const VoxelGrid& grid, const LayerRange& range) const {
    io::StackDescription stack =
        printer.describe({std::uint32_t(grid.size[0]), std::uint32_t(grid.size[1]), std::uint32_t(range.layers())});
    stack.first_layer = std::uint32_t(range.first);
    stack.origin_mm = {grid.origin_mm.x(), grid.origin_mm.y(), grid.origin_mm.z()};
    stack.resins = resins.entries;
    return stack;
}

}  // namespace voxtone::slicer

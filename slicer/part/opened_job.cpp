// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/opened_job.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "halftone/separation/invert_appearance.h"
#include "io/profiles/resin_family.h"
#include "io/profiles/resin_file.h"
#include "slicer/options/resolve_job.h"

namespace voxtone::slicer {

namespace {

/// How thick a picture's slab is, is known without the picture; which way it is turned then, not here.
void check_thickness(const ResolvedJob& job, const PrinterProfile& printer) {
    if (!job.is_picture() || !job.placement.rotation.isIdentity(0)) return;
    const Eigen::Vector3d slab_mm(1, 1, printed_mm(job.picture, job.colour));
    check_layer_count(grid_around(Eigen::Vector3d::Zero(), slab_mm, printer.sliced_pitch_mm()).size[2], printer,
                      "thicker (--thickness)");
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
    OpenedJob job{resolve(asked), {}, {}, nullptr, {}, {}};
    ResolvedJob& options = job.options;
    check_model(options);
    job.other = open_other_print(options);
    job.printer = find_printer(options.printer);
    if (options.resins.empty())
        options.resins = options.raw.resins =
            job.other ? job.other->usual_resins(job.printer) : usual_resins(options, job.printer);
    job.printer.load(options.resins, io::resin_family(options.resins));
    job.resins = load_resins(options, job.printer);
    check_thickness(options, job.printer);
    if (job.other) job.other->check(job.resins);
    colour_marks_by_resin(job);
    job.run.goes_on = options.resume;
    job.run.loop_elsewhere = options.sharded;
    return job;
}

OpenedJob open_job(const SliceOptions& asked, const DecideRun& decide) {
    OpenedJob job = open_job(asked);
    decide(job, job.run);
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

// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/component.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/core.h>

#include "base/error.h"
#include "slicer/layers/layer_bytes.h"
#include "slicer/layers/mixture_body.h"
#include "slicer/layers/plain_body.h"
#include "slicer/plate/finished_stack.h"
#include "slicer/plate/part_outline.h"

namespace voxtone::slicer {

namespace {

/// Whole voxels, as near to the sizes as they come.
VoxelGrid grid_of(const TrayComponent& component, const PrinterProfile& printer) {
    VoxelGrid grid;
    grid.pitch_mm = printer.sliced_pitch_mm();
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double pitch = grid.pitch_mm[Eigen::Index(axis)], voxels = std::round(component.size_mm[axis] / pitch);
        if (voxels < 1)
            throw InputError(
                fmt::format("is {:g} mm along {}, less than half a voxel of {:.4g} mm: nothing would be "
                            "printed; make it larger",
                            component.size_mm[axis], "xyz"[axis], pitch));
        if (voxels > 65535)
            throw InputError(
                fmt::format("is {:g} mm along {}, {:.0f} voxels; a layer has 65535 at most: make it smaller",
                            component.size_mm[axis], "xyz"[axis], voxels));
        grid.size[axis] = static_cast<int>(voxels);
    }
    return grid;
}

void say_rounding(const TrayPart& part, const VoxelGrid& grid, Progress& progress) {
    double most_um = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
        most_um = std::max(most_um, 1e3 * std::abs(grid.size[axis] * grid.pitch_mm[Eigen::Index(axis)] -
                                                   part.component->size_mm[axis]));
    if (constexpr double least_um = 1; most_um < least_um) return;
    progress.note(fmt::format("{}: is {:.3f} x {:.3f} x {:.3f} mm, in whole voxels of {:.4g} x {:.4g} x {:.4g} um",
                              part.name, grid.size[0] * grid.pitch_mm.x(), grid.size[1] * grid.pitch_mm.y(),
                              grid.size[2] * grid.pitch_mm.z(), grid.pitch_mm.x() * 1e3, grid.pitch_mm.y() * 1e3,
                              grid.pitch_mm.z() * 1e3));
}

/// Of each loaded resin. Of what cuts it does not matter of what it is.
std::vector<double> shares_of(const TrayComponent& component, const LoadedResins& resins) {
    std::vector<double> shares(resins.entries.size());
    for (const ResinShare& one : component.mixture) {
        const auto resin = loaded_resin(resins, one.resin);
        if (!resin) refuse_resin(one.resin, resins);
        shares[*resin] += one.share;
    }
    if (component.mixture.empty()) shares[0] = 1;
    return shares;
}

ReadyComponent prepare_shape(const TrayPart& part, const OpenedJob& common, Progress& progress) {
    const TrayComponent& component = *part.component;
    const VoxelGrid grid = grid_of(component, common.printer);
    say_rounding(part, grid, progress);
    const std::vector<double> shares = shares_of(component, common.resins);
    const Eigen::Vector3d& pitch = grid.pitch_mm;
    const auto body = std::make_shared<const PlainBody>(
        grid, component.kind == ComponentKind::cylinder ? component.size_mm[0] : 0, cumulative_mixture(shares),
        static_cast<int>(shares.size()), halftone::BlueNoiseScreen({pitch.x(), pitch.y(), pitch.z()}, &progress));
    ReadyComponent made{body, empty_outline(grid), {}, {}, true};
    for (int j = 0; j < grid.size[1]; ++j)
        if (const int margin = body->margin(j); 2 * margin < grid.size[0])
            take_voxels(made.outline, grid, j, margin, grid.size[0] - margin);
    // What the screen makes of the shares depends on the place; their sum does not.
    const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
    const double voxels = double(body->voxels_of_layer()) * grid.size[2];
    if (voxels == 0) throw InputError("holds the centre of no voxel: nothing would be printed; make it larger");
    for (const double share : shares) made.voxels.push_back(std::uint64_t(std::llround(voxels * share / sum)));
    return made;
}

/// A model in its place, of one mixture.
ReadyComponent prepare_solid(const TrayPart& part, const OpenedJob& common, Progress& progress) {
    SliceOptions options = part.options;
    options.out = common.options.out.string();
    options.load.clear();
    for (const io::StackResin& resin : common.resins.entries) options.load.push_back(resin.role);
    const OpenedJob job = open_job(options);
    const JobBody body = prepare_body(job.options, job.printer, progress);
    for (const std::string& warning : body.warnings)
        if (warning.find("[no-colour]") == std::string::npos) progress.warn(warning);
    const std::vector<double> shares = shares_of(*part.component, common.resins);
    const Eigen::Vector3d& pitch = body.grid.pitch_mm;
    MixtureFill fill(cumulative_mixture(shares), static_cast<int>(shares.size()),
                     halftone::BlueNoiseScreen({pitch.x(), pitch.y(), pitch.z()}, &progress));
    ReadyComponent made{std::make_shared<const MixtureBody>(Solid(*body.solid, body.grid), std::move(fill)),
                        outline_of(body),
                        {},
                        {part.component->path},
                        true};
    const double sum = std::accumulate(shares.begin(), shares.end(), 0.0), voxels = double(voxels_of(body));
    if (voxels == 0) throw InputError("holds the centre of no voxel: nothing would be printed; make it larger");
    for (const double share : shares) made.voxels.push_back(std::uint64_t(std::llround(voxels * share / sum)));
    return made;
}

}  // namespace

ReadyComponent prepare_component(const TrayPart& part, const OpenedJob& common, Progress& progress) {
    if (part.component->kind == ComponentKind::body) return prepare_solid(part, common, progress);
    return part.component->is_shape() ? prepare_shape(part, common, progress)
                                      : open_finished_stack(*part.component, common, progress);
}

std::uint64_t component_disk_bytes(const ReadyComponent& component, bool cuts, const OpenedJob& common) {
    const VoxelGrid& grid = component.layers->grid();
    const bool screened = std::ranges::count_if(component.voxels, [](auto count) { return count > 0; }) > 1;
    const double screened_mm3 = screened && !cuts ? double(component.all_voxels()) * grid.voxel_volume_mm3() : 0;
    return layer_bytes(grid, {screened_mm3, 1, grid.size[2], common.outputs(), common.resins.entries.size()});
}

}  // namespace voxtone::slicer

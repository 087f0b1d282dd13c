// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/printer/placement.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <Eigen/Geometry>

#include "base/error.h"
#include "slicer/mesh/box.h"
#include "slicer/printer/tray_room.h"

namespace voxtone::slicer {

namespace {

void turn_around(io::TexturedMesh& mesh) {
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
    for (auto& uv : mesh.corner_uv) std::swap(uv[1], uv[2]);
    for (auto& rgb : mesh.corner_rgb) std::swap(rgb[1], rgb[2]);
    for (auto& alpha : mesh.corner_alpha) std::swap(alpha[1], alpha[2]);
}

/// What decides how large the print is.
std::string size_options(const Placement& placement, bool may_turn = false) {
    if (placement.is_picture) return "Give another --width or --thickness";
    const std::string give = placement.is_scaled ? "give another --size" : "give the right --unit, or a --size";
    return (may_turn ? "Turn it with --rotate, or " : "To print it ") + give;
}

/// Lying in another way.
bool would_fit_turned(Eigen::Vector3d size_mm, Eigen::Vector3d tray_mm) {
    std::ranges::sort(size_mm), std::ranges::sort(tray_mm);
    return fits_in(size_mm[0], tray_mm[0]) && fits_in(size_mm[1], tray_mm[1]) && fits_in(size_mm[2], tray_mm[2]);
}

/// "x and z".
std::string axes_too_long(const Eigen::Vector3d& size_mm, const Eigen::Vector3d& tray_mm, int surely) {
    std::vector<std::string> axes;
    for (int axis = 0; axis < 3; ++axis)
        if (axis == surely || !fits_in(size_mm[axis], tray_mm[axis])) axes.emplace_back(1, "xyz"[axis]);
    const std::string last = axes.back();
    axes.pop_back();
    return axes.empty() ? last : fmt::format("{} and {}", fmt::join(axes, ", "), last);
}

/// A length in mm as a person writes it, four digits or all before the point, whatever a file holds.
std::string plain_mm(double mm, int digits = 4) {
    constexpr double least = 1e-4, most = 1e6, whole = 1e3;
    if (mm != 0 && mm < least) return fmt::format("under {}", least);
    if (!(mm < most)) return "over 1 000 000";
    return mm < whole || digits > 4 ? fmt::format("{:.{}g}", mm, digits) : fmt::format("{:.0f}", mm);
}

std::string extent_text(const Eigen::Vector3d& mm) {
    return fmt::format("{} x {} x {} mm", plain_mm(mm.x()), plain_mm(mm.y()), plain_mm(mm.z()));
}

/// With so many digits that lengths which are not those of `other` look otherwise.
std::string extent_text_beside(const Eigen::Vector3d& mm, const Eigen::Vector3d& other) {
    constexpr int most_digits = 9;
    std::string text;
    for (int axis = 0; axis < 3; ++axis) {
        int digits = 4;
        while (digits < most_digits && std::abs(mm[axis] - other[axis]) > tray_slack_mm &&
               plain_mm(mm[axis], digits) == plain_mm(other[axis]))
            ++digits;
        text += (axis > 0 ? " x " : "") + plain_mm(mm[axis], digits);
    }
    return text + " mm";
}

/// "As mm (--unit mm) it is 72.5 mm long. ": files are often in another unit than they say, or than was assumed.
std::string units_that_fit(const Eigen::Vector3d& size_mm, const Eigen::Vector3d& tray_mm, const Placement& placement) {
    constexpr double least_mm = 2;  // a smaller print is seldom meant
    if (placement.is_picture || placement.is_scaled) return {};
    std::string text;
    for (const auto& [name, mm] : {std::pair{"mm", 1.0}, {"cm", 10.0}, {"in", 25.4}, {"m", 1000.0}}) {
        const Eigen::Vector3d size = size_mm * (mm / placement.mm_per_file_unit);
        const bool fits = fits_in(size.x(), tray_mm.x()) && fits_in(size.y(), tray_mm.y()) &&
                          fits_in(size.z(), tray_mm.z()) && size.maxCoeff() >= least_mm;
        if (fits)
            text +=
                fmt::format("{} {} (--unit {}) it is {}", text.empty() ? "As" : ", as", name, name, extent_text(size));
    }
    return text.empty() ? text : text + ". ";
}

[[noreturn]] void refuse_for_tray(const Eigen::Vector3d& size_mm, const Eigen::Vector3d& tray_mm, int axis,
                                  const Placement& placement) {
    const std::string unit = placement.is_picture || placement.is_scaled ? ""
                             : placement.unit_assumed                    ? " (mm was assumed)"
                                                      : fmt::format(" ({:g} mm per unit)", placement.mm_per_file_unit);
    throw InputError(fmt::format("the model is {}{} and the printer's tray {}: too large along {} by {}. {}{}",
                                 extent_text_beside(size_mm, tray_mm), unit, extent_text(tray_mm),
                                 axes_too_long(size_mm, tray_mm, axis), excess_text((size_mm - tray_mm).maxCoeff()),
                                 units_that_fit(size_mm, tray_mm, placement),
                                 size_options(placement, would_fit_turned(size_mm, tray_mm))));
}

/// Lengths that light goes in a body are scaled with it. What is said of that, or nothing.
std::string keep_look(io::ModelFile& model, double mm_per_unit) {
    const double times = model.mm_per_file_unit > 0 ? mm_per_unit / model.mm_per_file_unit : 1;
    constexpr double rounding = 1e-9;
    if (std::abs(times - 1) < rounding) return {};
    bool any = false;
    for (io::SurfaceMaterial& material : model.mesh.materials) {
        if (!material.alpha_of_lengths) continue;
        material.times_as_large = times;
        any = true;
    }
    return any ? fmt::format("; what light goes through keeps its look at {:.3g} times the file's size", times) : "";
}

}  // namespace

Placement place(io::ModelFile& model, const PlacementOptions& options, const std::string& name) {
    Placement placement;
    if (options.unit) {
        placement.mm_per_file_unit = options.unit->mm;
    } else if (model.mm_per_file_unit > 0) {
        placement.mm_per_file_unit = model.mm_per_file_unit;
    } else {
        placement.unit_assumed = true;
    }

    Eigen::Matrix3d map = options.rotation * (placement.mm_per_file_unit * options.scale);
    if (options.swap_xy) map.row(0).swap(map.row(1));
    if (options.flip_x) map.row(0) *= -1;
    if (options.flip_y) map.row(1) *= -1;

    io::TexturedMesh& mesh = model.mesh;
    for (Eigen::Vector3d& position : mesh.positions) position = map * position;
    if (map.determinant() < 0) turn_around(mesh);

    placement.is_picture = model.format == "picture";
    const Eigen::AlignedBox3d box = bounding_box(mesh.positions, mesh.triangles);
    const double largest = box.sizes().maxCoeff();
    if (!std::isfinite(largest))
        throw InputError(fmt::format("{}: the model is larger than any number. {}", name, size_options(placement)));
    if (!(largest > 0))
        throw InputError(
            fmt::format("{}: the model has no extent (all its corners are in one place); check the export", name));
    const double factor = options.size_mm > 0 ? options.size_mm / largest : 1.0;
    for (Eigen::Vector3d& position : mesh.positions) position = (position - box.min()) * factor;
    placement.extent_mm = box.sizes() * factor;
    const std::string kept_look = keep_look(model, placement.mm_per_file_unit * options.scale * factor);
    placement.is_scaled = options.size_mm > 0;
    placement.corner_mm = box.min() * factor;

    const std::string unit = model.format == "picture" ? "mm"
                             : placement.unit_assumed  ? "mm assumed (the format has no unit; --unit says otherwise)"
                             : options.unit            ? fmt::format("{} as asked", options.unit->name)
                                                       : fmt::format("{} mm by the file", placement.mm_per_file_unit);
    placement.summary =
        fmt::format("unit: {}; size {}{}{}", unit, extent_text(placement.extent_mm),
                    options.size_mm > 0 ? fmt::format(" (scaled to {} mm)", plain_mm(options.size_mm)) : "", kept_look);
    return placement;
}

void check_extent(const Placement& placement, const Eigen::Vector3d& pitch_mm, const Eigen::Vector3d& tray_mm) {
    constexpr double largest_mm = 1e4;
    const Eigen::Vector3d& extent = placement.extent_mm;
    const Eigen::Vector3d room = tray_mm.cwiseMin(largest_mm);
    for (int axis = 0; axis < 3; ++axis)
        if (!fits_in(extent[axis], room[axis])) refuse_for_tray(extent, room, axis, placement);
    // A picture's slab has a thickness of its own: its width says how large it is.
    const double largest_extent = placement.is_picture ? extent.head<2>().maxCoeff() : extent.maxCoeff();
    if (largest_extent < pitch_mm.maxCoeff())
        throw InputError(
            fmt::format("the model is {}, less than one voxel of the printer ({}): nothing of it could be printed. {}",
                        extent_text(extent), extent_text(pitch_mm), size_options(placement)));
}

VoxelGrid grid_around(const Eigen::Vector3d& low_mm, const Eigen::Vector3d& high_mm, const Eigen::Vector3d& pitch_mm) {
    VoxelGrid grid;
    grid.pitch_mm = pitch_mm;
    for (int axis = 0; axis < 3; ++axis) {
        const double length_mm = high_mm[axis] - low_mm[axis];
        if (!(length_mm / pitch_mm[axis] < 1e7))
            throw InputError(
                fmt::format("the model is {:.3g} m along {}; no printer is so large. Give --unit or --size",
                            length_mm / 1000, "xyz"[axis]));
        grid.size[static_cast<std::size_t>(axis)] = voxels_in(length_mm, pitch_mm[axis]);
        grid.origin_mm[axis] =
            0.5 * (low_mm[axis] + high_mm[axis] - pitch_mm[axis] * grid.size[static_cast<std::size_t>(axis)]);
    }
    return grid;
}

void check_tray(const VoxelGrid& grid, const Eigen::Vector3d& tray_mm, const Placement& placement) {
    const Eigen::Vector3d size = grid.pitch_mm.cwiseProduct(Eigen::Vector3d(grid.size[0], grid.size[1], grid.size[2]));
    for (int axis = 0; axis < 3; ++axis)
        if (grid.size[static_cast<std::size_t>(axis)] > voxels_in_room(tray_mm[axis], grid.pitch_mm[axis]))
            refuse_for_tray(size, tray_mm, axis, placement);
}

void check_layer_count(int layers, const PrinterProfile& printer, const std::string& remedy) {
    const double layer_mm = printer.sliced_pitch_mm().z();
    if (layers < printer.min_layers)
        throw InputError(
            fmt::format("the print has {} layer{} ({:.3g} mm), and {} takes no fewer than {} ({:.3g} mm): make it {}",
                        layers, layers == 1 ? "" : "s", layers * layer_mm, printer.id, printer.min_layers,
                        printer.min_layers * layer_mm, remedy));
}

}  // namespace voxtone::slicer

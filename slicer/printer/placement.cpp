// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/printer/placement.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include <fmt/core.h>
#include <Eigen/Geometry>

#include "voxtone/base/error.h"
#include "voxtone/base/units.h"
#include "voxtone/slicer/mesh/box.h"

namespace voxtone::slicer {

namespace {

/// Multiples of 90 degrees come out exact, so that an upright box stays upright to the last bit.
Eigen::Matrix3d axis_rotation(int axis, double degrees) {
    const double radians = degrees * std::numbers::pi / 180;
    double c = std::cos(radians), s = std::sin(radians);
    if (std::fmod(degrees, 90.0) == 0) c = std::round(c), s = std::round(s);
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    matrix(u, u) = c, matrix(u, v) = -s, matrix(v, u) = s, matrix(v, v) = c;
    return matrix;
}

void turn_around(io::TexturedMesh& mesh) {
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
    for (auto& uv : mesh.corner_uv) std::swap(uv[1], uv[2]);
    for (auto& rgb : mesh.corner_rgb) std::swap(rgb[1], rgb[2]);
}

}  // namespace

Eigen::Matrix3d parse_rotation(const std::string& text) {
    Eigen::Matrix3d whole = Eigen::Matrix3d::Identity();
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const int axis = text[begin] == 'x' ? 0 : text[begin] == 'y' ? 1 : text[begin] == 'z' ? 2 : -1;
        double degrees = 0;
        const auto [rest, status] = std::from_chars(text.data() + begin + 1, text.data() + end, degrees);
        if (axis < 0 || status != std::errc{} || rest != text.data() + end || !std::isfinite(degrees))
            throw UsageError(
                fmt::format("--rotate: '{}' is no rotation; write an axis and degrees, such as x90 or z45,x-30", text));
        whole = axis_rotation(axis, degrees) * whole;
        begin = end + 1;
    }
    return whole;
}

Placement place(io::ModelFile& model, const SliceOptions& options) {
    Placement placement;
    if (options.unit != "auto") {
        placement.mm_per_file_unit = mm_per_unit(options.unit);
    } else if (model.mm_per_file_unit > 0) {
        placement.mm_per_file_unit = model.mm_per_file_unit;
    } else {
        placement.unit_assumed = true;
    }

    Eigen::Matrix3d map = parse_rotation(options.rotate) * (placement.mm_per_file_unit * options.scale);
    if (options.swap_xy) map.row(0).swap(map.row(1));
    if (options.flip_x) map.row(0) *= -1;
    if (options.flip_y) map.row(1) *= -1;

    io::TexturedMesh& mesh = model.mesh;
    for (Eigen::Vector3d& position : mesh.positions) position = map * position;
    if (map.determinant() < 0) turn_around(mesh);

    const Eigen::AlignedBox3d box = bounding_box(mesh.positions, mesh.triangles);
    const double largest = box.sizes().maxCoeff();
    if (!(largest > 0) || !std::isfinite(largest))
        throw InputError(fmt::format("{}: the model has no extent (all its corners are in one place); check the export",
                                     options.model));
    const double factor = options.size_mm > 0 ? options.size_mm / largest : 1.0;
    for (Eigen::Vector3d& position : mesh.positions) position = (position - box.min()) * factor;
    placement.extent_mm = box.sizes() * factor;

    const std::string unit = model.format == "picture" ? "mm"
                             : placement.unit_assumed  ? "mm assumed (the format has no unit; --unit says otherwise)"
                             : options.unit != "auto"  ? fmt::format("{} as asked", options.unit)
                                                       : fmt::format("{} mm by the file", placement.mm_per_file_unit);
    placement.summary = fmt::format("unit: {}; size {:.4g} x {:.4g} x {:.4g} mm{}", unit, placement.extent_mm.x(),
                                    placement.extent_mm.y(), placement.extent_mm.z(),
                                    options.size_mm > 0 ? fmt::format(" (scaled to {:.6g} mm)", options.size_mm) : "");
    return placement;
}

VoxelGrid grid_around(const Eigen::Vector3d& low_mm, const Eigen::Vector3d& high_mm, const Eigen::Vector3d& pitch_mm) {
    VoxelGrid grid;
    grid.pitch_mm = pitch_mm;
    for (int axis = 0; axis < 3; ++axis) {
        // A millionth of a voxel of slack keeps a body of exactly n voxels from getting n + 1 through rounding.
        const double voxels = std::ceil((high_mm[axis] - low_mm[axis]) / pitch_mm[axis] - 1e-6);
        if (!(voxels < 1e7))
            throw InputError(
                fmt::format("the model is {:.3g} m along {}; no printer is so large. Give --unit or --size",
                            (high_mm[axis] - low_mm[axis]) / 1000, "xyz"[axis]));
        grid.size[static_cast<std::size_t>(axis)] = std::max(1, static_cast<int>(voxels));
        grid.origin_mm[axis] =
            0.5 * (low_mm[axis] + high_mm[axis] - pitch_mm[axis] * grid.size[static_cast<std::size_t>(axis)]);
    }
    return grid;
}

void check_tray(const VoxelGrid& grid, const Eigen::Vector3d& tray_mm, const Placement& placement) {
    const Eigen::Vector3d size = grid.pitch_mm.cwiseProduct(Eigen::Vector3d(grid.size[0], grid.size[1], grid.size[2]));
    for (int axis = 0; axis < 3; ++axis)
        if (size[axis] > tray_mm[axis])
            throw InputError(fmt::format(
                "the model is {:.4g} x {:.4g} x {:.4g} mm and the printer's tray {:.4g} x {:.4g} x {:.4g} mm ({}): too "
                "large along {}. "
                "Give the right --unit, or a --size, or turn it with --rotate",
                size.x(), size.y(), size.z(), tray_mm.x(), tray_mm.y(), tray_mm.z(),
                placement.unit_assumed ? "mm was assumed" : fmt::format("{:g} mm per unit", placement.mm_per_file_unit),
                "xyz"[axis]));
}

}  // namespace voxtone::slicer

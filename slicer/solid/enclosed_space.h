// SPDX-License-Identifier: GPL-3.0-or-later
//
// Space that a body's surface shuts off from outside, found on cubic cells some voxels wide.
//
// A cell is free where no triangle touches it and its centre lies in no body (winding number 0); cells that share a
// face are neighbours. Free cells that cannot be reached from outside are voids. So what is narrower than a cell is no
// way in, whatever lies behind it, and what is wider than three always is: holes of a quarter of a millimetre do not
// join the space within a shell to the space around it. `closing` widens that: a way in must let a cube of
// 2 closing + 1 cells pass.
//
// Cost: a byte a cell, and a pass over cells and triangles. Error: volumes are those of whole free cells, so a layer of
// cells along the walls is missing from them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "slicer/mesh/solid_mesh.h"

namespace voxtone::slicer {

struct EnclosureOptions {
    double cell_mm = 0.25;      ///< > 0; widened so that there are no more than 2^26 cells
    int closing = 0;            ///< cells
    double smallest_mm3 = 0.5;  ///< of free cells: what is smaller is a pocket, no void
};

struct EnclosedVoid {
    double cells_mm3 = 0;
    Eigen::Vector3d inside_mm = Eigen::Vector3d::Zero();  ///< a point in one of its cells
    Eigen::Vector3d centre_mm = Eigen::Vector3d::Zero();  ///< of its cells
};

class EnclosedSpace {
public:
    using Label = std::uint8_t;
    /// `wall`: a triangle touches the cell, or it lies in the body. `pocket`: shut off, and too small to be a void.
    static constexpr Label wall = 0, outside = 1, pocket = 2, first_void = 3;

    /// `solid` is closed as a chain. Throws Cancelled.
    explicit EnclosedSpace(const SolidMesh& solid, const EnclosureOptions& options = {},
                           const Progress* progress = nullptr);

    [[nodiscard]] double cell_mm() const { return cell_mm_; }
    /// The largest first, no more than 250; void n has the label first_void + n.
    [[nodiscard]] const std::vector<EnclosedVoid>& voids() const { return voids_; }
    /// Of the cell that holds a point.
    [[nodiscard]] Label at(const Eigen::Vector3d& p) const;
    /// A closed surface, made of the faces of cells, around a void and the walls' cells beside it: it reaches into the
    /// walls by a cell at most. Its triangles have no source.
    [[nodiscard]] SolidMesh plug(Label of_void) const;

private:
    [[nodiscard]] std::size_t index(int i, int j, int k) const {
        return (std::size_t(k) * std::size_t(size_[1]) + std::size_t(j)) * std::size_t(size_[0]) + std::size_t(i);
    }
    void lay_cells(const SolidMesh& solid, const EnclosureOptions& options);
    void mark_surface(const SolidMesh& solid);
    void mark_triangle(const std::array<Eigen::Vector3d, 3>& corners);
    void mark_inside(const SolidMesh& solid);
    [[nodiscard]] std::vector<bool> closed(int cells) const;
    void label_free(const std::vector<bool>& shut, double smallest_mm3);
    void grow_into(const std::vector<bool>& shut, int steps);
    [[nodiscard]] std::vector<bool> with_walls(Label of_void) const;

    double cell_mm_ = 0;
    Eigen::Vector3d origin_mm_ = Eigen::Vector3d::Zero();
    std::array<int, 3> size_{};
    std::vector<Label> label_;
    std::vector<EnclosedVoid> voids_;
};

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The surface shell: for every voxel of the body whose centre is within `depth` of the coloured surface, the nearest
// surface point and its distance. Deeper voxels are core and cost next to nothing.
//
// How: the grid is cut into blocks of 8 voxels along x and about as many millimetres along y and z, anchored at voxel
// (0, 0, 0). For four blocks in a row, the tree gives the surface point nearest to their centre and then every triangle
// that may hold the nearest point of any place in them; this list is thinned for each block by the same rule, and each
// voxel is compared with what is left in single precision, in the frame of the four.
//
// Error: distances are within 1e-6 mm + 1e-6 relative of the true ones (blocks up to 1 mm wide; it grows with them),
// and voxels are in the shell by that distance; what a relief makes of their depth is told, and changes nothing else.
// Among triangles at the same distance (to 2e-6 relative or 1e-8 mm^2 of its square) the lowest index is taken. Results
// depend on nothing but surface, grid, depth and body: not on threads, the instruction set, or how the grid is walked.
// Threads: const members may be called from any thread.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>

#include "slicer/mesh/triangle_tree.h"
#include "slicer/printer/voxel_grid.h"
#include "slicer/solid/relief.h"
#include "slicer/solid/span_slab.h"
#include "slicer/surface/visible_surface.h"

namespace voxtone::slicer {

/// A block that has shell voxels. Row r = z * size[1] + y holds the voxels origin + (0..7, y, z); voxel l of row r is
/// bit l of `shell[r]` and element r * 8 + l of the lists, which are undefined where the bit is 0.
struct ShellBlock {
    static constexpr int width = 8;
    static constexpr int max_rows = 128;
    std::array<int, 3> origin{};
    std::array<int, 3> size{};
    const std::uint8_t* shell = nullptr;
    const float* distance_mm = nullptr;
    const std::uint32_t* triangle = nullptr;  ///< of the visible surface
    const float* u = nullptr;                 ///< weight of corner 1 of the source triangle
    const float* v = nullptr;                 ///< weight of corner 2; corner 0 has 1 - u - v
};

class SurfaceShell {
public:
    /// Keeps references to `surface` and `relief` (null: none), which must live as long as this. depth_mm >= 0.
    SurfaceShell(const SurfaceIndex& surface, const VoxelGrid& grid, double depth_mm, const Relief* relief = nullptr);
    /// Of triangles without a source: u and v are 0. Keeps a reference to `tree`.
    SurfaceShell(const TriangleTree& tree, const VoxelGrid& grid, double depth_mm);
    ~SurfaceShell();

    [[nodiscard]] const VoxelGrid& grid() const { return grid_; }
    [[nodiscard]] double depth_mm() const { return depth_mm_; }
    /// Voxels of a block along x, y, z.
    [[nodiscard]] std::array<int, 3> block_size() const { return block_size_; }
    /// Rows of blocks along y, layers of blocks along z; the last may reach beyond the grid.
    [[nodiscard]] int block_rows() const { return (grid_.size[1] + block_size_[1] - 1) / block_size_[1]; }
    [[nodiscard]] int block_layers() const { return (grid_.size[2] + block_size_[2] - 1) / block_size_[2]; }

    /// Visits, along +x, the blocks of block row `bj`, block layer `bk` that have shell voxels and touch the columns
    /// [i_begin, i_end). Voxels of layers that `body` does not hold are left out, so a slab may end anywhere. The block
    /// is valid during the call only.
    void for_each_block(int bj, int bk, const SpanSlab& body, const std::function<void(const ShellBlock&)>& visit,
                        int i_begin = 0, int i_end = std::numeric_limits<int>::max()) const;

private:
    struct Lattice;
    class RowWalk;

    SurfaceShell(const TriangleTree& tree, std::span<const std::array<Eigen::Vector2f, 3>> source_uv,
                 const VoxelGrid& grid, double depth_mm);

    const TriangleTree& tree_;
    std::span<const std::array<Eigen::Vector2f, 3>> source_uv_;  ///< per triangle, or empty
    VoxelGrid grid_;
    double depth_mm_;
    const Relief* relief_ = nullptr;
    std::array<int, 3> block_size_;
    std::unique_ptr<const Lattice> lattice_;
};

}  // namespace voxtone::slicer

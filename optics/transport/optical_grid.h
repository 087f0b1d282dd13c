// SPDX-License-Identifier: GPL-3.0-or-later
//
// The cells on which the transport predictor works: fine ones in the coloured skin, coarser ones below, coarser still
// towards the core.
//
// The volume is cut into blocks of 4 x 4 x 4 viewing cells (J750: a viewing cell is 2 x 1 x 3 voxels, a block 0.34 mm).
// Blocks are of one of these kinds:
//   skin        several materials, or a surface: cells of `skin_voxels` (one voxel by default); transport
//   margin      one material, near a skin block or on a sheet: cells of one viewing cell; transport
//   core        one material, deeper: no transport, the light is diffuse there
// Besides, diffusion has nodes everywhere: one per viewing cell in skin and margin, in core blocks 8 next to the margin
// and near surfaces, and 1 beyond. Faces of transport cells that lead out of the transport region are kept in a list of
// their own: to the light, onto a sheet, to a mirror, or into the core.
//
// Everything here is geometry; optical figures of a channel come from the palette of media.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "voxtone/base/progress.h"
#include "voxtone/optics/scene/appearance_model.h"
#include "voxtone/optics/transport/transport_directions.h"

namespace voxtone::optics {

/// Bit 6 of OpticalGrid::outer.
inline constexpr std::uint8_t not_solid = 64;

struct GridOptions {
    std::array<int, 3> view_voxels{2, 1, 3};  ///< voxels per viewing cell
    std::array<int, 3> skin_voxels{1, 1, 1};  ///< voxels per skin cell; divides view_voxels
    int margin_blocks = 2;                    ///< rings of margin blocks around the skin, at least
    int fine_core_blocks = 1;                 ///< rings of core blocks with 8 nodes around the margin
    /// Most entries of the palette of cells, whose numbers have 16 bits; what comes later is taken for the nearest.
    std::size_t most_mixtures = 65535;
};

enum class BlockKind : std::uint8_t { skin, margin, core };

struct GridBlock {
    std::array<std::int32_t, 3> at{};  ///< in the lattice of blocks
    BlockKind kind{};
    std::uint8_t nodes_per_edge = 4;  ///< 4, 2 or 1
    std::uint32_t medium = 0;         ///< the one material, or 0
    std::uint32_t first_cell = 0;     ///< of its cells; none in a core block
    std::uint32_t first_node = 0;
    std::uint64_t node_mask = 0;   ///< which of its 64 or 8 places have a node (nodes_per_edge 4 or 2)
    std::int32_t first_link = -1;  ///< into `face_of_cell`; -1: no cell of it has an outer face
    std::uint32_t first_face = 0, faces = 0;
    std::int32_t first_region = -1;  ///< of its 8 regions; -1: all its faces are flat
    std::array<std::int32_t, 6> neighbour{-1, -1, -1, -1, -1, -1};
};

enum class FaceKind : std::uint8_t { light, black_sheet, white_sheet, mirror, core };

/// A face through which a transport cell borders on something that is not a transport cell.
struct OuterFace {
    std::uint32_t cell = 0, node = 0;
    std::uint32_t beyond = 0;  ///< the core node on the other side
    FaceKind kind{};
    Facing facing{};
    std::uint8_t region_in_block = 0;
    float area_mm2 = 0;
};

/// Octant of the light that leaves through a face, of these signs along it (bits as in sweep_half).
[[nodiscard]] constexpr int leaving_octant(Facing facing, int signs) {
    const int f = static_cast<int>(facing), against = f % 2 == 0 ? 1 : 0;
    switch (f / 2) {
        case 0:
            return against | signs << 1;
        case 1:
            return (signs & 1) | against << 1 | (signs & 2) << 1;
        default:
            return signs | against << 2;
    }
}
/// Octant of the light that enters there, of the same signs along the face.
[[nodiscard]] constexpr int entering_octant(Facing facing, int signs) {
    return leaving_octant(facing, signs) ^ (1 << static_cast<int>(facing) / 2);
}

/// Two diffusion nodes side by side: `facing` is that of `a` towards `b`.
struct NodeContact {
    std::uint32_t a = 0, b = 0;
    std::uint8_t axis = 0;
    float area_mm2 = 0;
};

/// Place and size of a diffusion node: half edge lengths and centre in units of viewing cells.
struct GridNode {
    std::array<float, 3> centre{};
    float edge_cells = 1;                      ///< edge length in viewing cells
    float solid_share = 1;                     ///< of its volume
    std::array<float, 3> open_share{1, 1, 1};  ///< of its faces towards +x, +y, +z: resin on both sides
};

/// A mixture of materials; shares sum to 1.
struct PaletteEntry {
    std::vector<std::pair<Material, float>> shares;
};

/// How much a grid would take, without making it.
class GridCensus {
public:
    GridCensus(const Scene& scene, const GridOptions& options, const Progress* progress = nullptr);
    /// Of grid, equations and one channel's light (transport_channel.h), where skin cells are cut into so many.
    [[nodiscard]] std::size_t bytes(std::size_t split = 1) const;

private:
    std::size_t skin_ = 0, other_ = 0;
};

class OpticalGrid {
public:
    /// Throws Cancelled.
    OpticalGrid(const Scene& scene, const GridOptions& options, const Progress* progress = nullptr);

    GridOptions options;
    DirectionSet directions;
    std::array<int, 3> lattice{};       ///< blocks along each axis
    std::array<int, 3> shift_voxels{};  ///< voxel 0 lies so many voxels inside the first block
    std::array<double, 3> pitch_mm{};
    std::vector<GridBlock> blocks;       ///< ascending in z, y, x
    std::vector<std::int32_t> block_at;  ///< of each lattice place, -1: air
    /// First transport block of each row of blocks along x, with an end mark.
    std::vector<std::uint32_t> transport_rows;
    std::vector<std::uint32_t> transport_blocks;
    std::vector<std::uint16_t> medium;       ///< per cell: index into `palette`; 0 is air
    std::vector<std::uint8_t> outer;         ///< per cell: bit f is set where face f is an outer one; or `not_solid`
    std::vector<std::int32_t> face_of_cell;  ///< first outer face of a cell, per cell of blocks that have any
    std::vector<OuterFace> faces;            ///< those of a cell in order of `Facing`
    std::vector<FaceLaw> laws;               ///< of faces; 0 lets nothing through
    std::vector<std::uint32_t> law;          ///< per face
    std::size_t regions = 0;                 ///< where light that passes corners of the staircase is pooled
    /// [region * 64 + octant * 8 + direction]: w |Omega . e| area that a furnace sends past corners, and has room for.
    std::vector<float> pool_out, pool_in;
    std::vector<GridNode> nodes;
    std::vector<std::uint32_t> node_block;  ///< block of each node
    std::vector<NodeContact> contacts;
    std::vector<PaletteEntry> palette;  ///< of cells; entry m <= resins is resin m - 1 alone

    [[nodiscard]] std::array<int, 3> cells_in(BlockKind kind) const;    ///< cells of a block along each axis
    [[nodiscard]] std::array<int, 3> voxels_in(BlockKind kind) const;   ///< voxels of a cell along each axis
    [[nodiscard]] std::array<double, 3> edge_mm(BlockKind kind) const;  ///< of a cell
    /// Node that holds viewing cell (i, j, k) of a block, each in 0 .. 3; -1 where it has none.
    [[nodiscard]] std::int64_t node_at(const GridBlock& block, int i, int j, int k) const;
    /// The transport cell that holds a voxel, or -1.
    [[nodiscard]] std::int64_t cell_at(const std::array<int, 3>& voxel) const;
    /// The outer face that holds this face of a voxel, or -1.
    [[nodiscard]] std::int64_t face_at(const SurfaceFace& face) const;
    [[nodiscard]] const FaceLaw& law_of(std::size_t face) const { return laws[law[face]]; }
    [[nodiscard]] std::size_t memory_bytes() const;

private:
    friend class GridCensus;
    friend struct ViewingGrid;
    OpticalGrid() = default;
    struct Builder;
};

}  // namespace voxtone::optics

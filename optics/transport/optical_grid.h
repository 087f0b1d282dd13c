// SPDX-License-Identifier: GPL-3.0-or-later
//
// What light is swept through: blocks, their cells, and the faces at which it comes and goes.
//
// The volume is cut into blocks of 4 x 4 x 4 viewing cells (J750: a viewing cell is 2 x 1 x 3 voxels, a block 0.34 mm).
// Transport blocks have 64 cells, solid ones and others; core blocks, deep and of one material or of the mean of
// several (viewing_grid.h), have none: the light is diffuse there, and one node of diffusion stands for all of it.
// Faces of cells that lead out of the transport region are kept in a list of their own: to the light, onto a sheet, to
// a mirror, or into the core.
//
// Everything here is geometry; optical figures of a channel come from its media. Who makes it:
// viewing_grid_builder.h.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "voxtone/optics/scene/appearance_model.h"
#include "voxtone/optics/transport/transport_directions.h"

namespace voxtone::optics {

/// Bit 6 of OpticalGrid::outer.
inline constexpr std::uint8_t not_solid = 64;

enum class BlockKind : std::uint8_t { transport, core };

struct GridBlock {
    std::array<std::int32_t, 3> at{};  ///< in the lattice of blocks
    BlockKind kind{};
    bool slanting = false;         ///< has faces of a surface that is no face of the lattice: light passes corners
    std::uint32_t medium = 0;      ///< of a core block
    std::uint32_t first_cell = 0;  ///< of its cells; none in a core block
    std::uint32_t core_node = 0;   ///< of a core block
    std::uint64_t solid = 0;       ///< which of its 64 cells are
    std::int32_t first_link = -1;  ///< into `face_of_cell`; -1: no cell of it has an outer face
    std::uint32_t first_face = 0, faces = 0;
    std::array<std::int32_t, 6> neighbour{-1, -1, -1, -1, -1, -1};
};

enum class FaceKind : std::uint8_t { light, black_sheet, white_sheet, mirror, core };

/// A face through which a transport cell borders on something that is not a transport cell.
struct OuterFace {
    std::uint32_t cell = 0;
    std::uint32_t beyond = 0;  ///< the core node on the other side
    FaceKind kind{};
    Facing facing{};
    std::uint8_t region_in_block = 0;  ///< of 2 x 2 x 2 cells, in which light that passes corners is pooled
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

struct OpticalGrid {
    std::array<int, 3> view_voxels{2, 1, 3};  ///< voxels per cell
    DirectionSet directions;
    std::array<int, 3> lattice{};       ///< blocks along each axis
    std::array<int, 3> shift_voxels{};  ///< voxel 0 lies so many voxels inside the first block
    std::array<double, 3> pitch_mm{};
    std::vector<GridBlock> blocks;       ///< ascending in z, y, x
    std::vector<std::int32_t> block_at;  ///< of each lattice place, -1: air
    /// First transport block of each row of blocks along x, with an end mark.
    std::vector<std::uint32_t> transport_rows;
    std::vector<std::uint32_t> transport_blocks;
    std::vector<std::uint16_t> medium;       ///< per cell: number of what it holds (ViewingGrid::mixtures); 0 is air
    std::vector<std::uint8_t> outer;         ///< per cell: bit f is set where face f is an outer one; or `not_solid`
    std::vector<std::int32_t> face_of_cell;  ///< first outer face of a cell, per cell of blocks that have any
    std::vector<OuterFace> faces;            ///< those of a cell in order of `Facing`
    std::vector<FaceLaw> laws;               ///< of faces; 0 lets nothing through
    std::vector<std::uint32_t> law;          ///< per face

    /// Of a cell.
    [[nodiscard]] std::array<double, 3> edge_mm() const {
        std::array<double, 3> edge{};
        for (std::size_t a = 0; a < 3; ++a) edge[a] = view_voxels[a] * pitch_mm[a];
        return edge;
    }
    [[nodiscard]] const FaceLaw& law_of(std::size_t face) const { return laws[law[face]]; }
    [[nodiscard]] std::size_t memory_bytes() const;
};

}  // namespace voxtone::optics

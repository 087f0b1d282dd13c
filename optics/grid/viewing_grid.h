// SPDX-License-Identifier: GPL-3.0-or-later
//
// A body cut into cells of the eye: transport on viewing cells (J750: 2 x 1 x 3 voxels), for an optical grid that keeps
// its shape while the resins change.
//
// A cell is solid where at least half of its voxels are, or where no neighbour is that would stand for it. What a cell
// that is not solid holds is given to the fullest neighbour across a face, so that no resin is lost: a cell's
// extinction is that of its voxels times the volume of resin in it / the cell's volume, 0.5 to 2 or so at a slanting
// surface, 1 elsewhere. The surface is the staircase of solid cells; each of its faces has the normal of the smooth
// surface there, and the laws of transport_directions.h keep the flux per true area. A face of a voxel is seen through
// the nearest face of the staircase that looks the same way.
//
// Transport blocks (4 x 4 x 4 cells, all of them stored): those within `colour_mm` of the surface that is asked for,
// those at the surface elsewhere, those of several materials, and a margin of them as deep as what it holds is clear.
// Deeper, and on a sheet that lies deeper, each block is one node of diffusion. Cells and nodes of diffusion are the
// same. Where deep colour is in nodes, too (TransportOptions), blocks of several materials have cells only as far down
// as colour is expected, and deeper ones are nodes of the medium of the halftone of their shares.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "optics/grid/lattice.h"
#include "optics/grid/transport_directions.h"
#include "optics/media/lateral_spread.h"
#include "optics/scene/scene.h"
#include "optics/scene/surface.h"

namespace voxtone::optics {

/// The neighbour of a voxel, a cell or a block across face f (Facing).
[[nodiscard]] inline Place beside(const Place& at, std::size_t f) {
    return {at[0] + step_of[f][0], at[1] + step_of[f][1], at[2] + step_of[f][2]};
}

enum class BlockKind : std::uint8_t { transport, core };

struct GridBlock {
    Place at{};  ///< in the lattice of blocks
    BlockKind kind{};
    bool slanting = false;         ///< has faces of a surface that is no face of the lattice: light passes corners
    std::uint32_t first_cell = 0;  ///< of its cells; none in a core block
    std::uint32_t core_node = 0;   ///< of a core block
    std::uint64_t solid = 0;       ///< which of its 64 cells are
    std::uint32_t first_face = 0, faces = 0;     ///< ascending in cell, then facing
    std::array<std::uint8_t, 7> first_facing{};  ///< of its faces in GridFaces::by_facing, with an end mark
    std::array<std::int32_t, 6> neighbour{-1, -1, -1, -1, -1, -1};
};

enum class FaceKind : std::uint8_t {
    light,
    black_sheet,
    white_sheet,  ///< any that sends light back (GridMedia::sheet)
    mirror,
    core,
};

/// A face through which a transport cell borders on something that is not a transport cell.
struct OuterFace {
    std::uint32_t cell = 0;
    std::uint32_t beyond = 0;  ///< the core node on the other side
    FaceKind kind{};
    Facing facing{};
    std::uint8_t region_in_block = 0;  ///< of 2 x 2 x 2 cells, in which light that passes corners is pooled
    float area_mm2 = 0;
};

/// A face as a sweep asks for it.
struct FacingFace {
    std::uint32_t place;  ///< as GridFaces::place_of_face
    std::uint8_t cell_in_block;
};

/// Marks a place of GridFaces::place_of_face as one among the faces into the core.
inline constexpr std::uint32_t into_core = 0x80000000u;

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

/// The lattice of blocks of 4 x 4 x 4 viewing cells over a volume: from voxel 0 along x and y, from the top along z.
struct BlockLattice {
    BlockLattice(const Place& size, const Place& view_voxels);
    [[nodiscard]] std::uint64_t index(const Place& block) const { return at3(block, blocks); }
    Place block_voxels{}, blocks{};
    Place shift_voxels{};  ///< voxel 0 lies so many voxels inside the first block
};

/// A part of the lattice: blocks begin .. end - 1. Where the body goes on beyond (`cut`, by Facing), the outermost ring
/// of blocks holds no transport cells but one node each, a ghost: its light comes from who knows it
/// (ViewingTransport::solve).
struct ViewingWindow {
    Place begin{}, end{};
    std::array<bool, 6> cut{};
};

/// Where the blocks and cells of a window lie, and on what: known before anything is read.
struct GridFrame {
    GridFrame() = default;
    GridFrame(const Scene& scene, const Place& view_voxels, const ViewingWindow& window);

    [[nodiscard]] Place block_voxels() const { return {4 * view_voxels[0], 4 * view_voxels[1], 4 * view_voxels[2]}; }
    /// The lowest voxel of a block, and of a cell.
    [[nodiscard]] Place corner_of(const Place& block) const { return corner(block, 4); }
    [[nodiscard]] Place corner_of_cell(const Place& cell) const { return corner(cell, 1); }
    [[nodiscard]] bool is_ghost(const Place& block) const;
    /// A block of the lowest ones, that may reach below the sheet.
    [[nodiscard]] bool is_on_sheet(const Place& block) const {
        return backing != Backing::none && block[2] == 0 && corner_of(block)[2] <= 0;
    }
    [[nodiscard]] bool is_mirrored(std::size_t axis) const { return mirrored && axis < 2; }
    /// What lies beyond face f of a solid cell whose neighbour `next` is not solid.
    [[nodiscard]] FaceKind kind_beyond(const Place& next, std::size_t f) const;
    /// Of a cell.
    [[nodiscard]] std::array<double, 3> edge_mm() const;

    Place view_voxels{2, 1, 3};  ///< voxels per cell
    Place lattice{};             ///< blocks along each axis
    Place shift_voxels{};        ///< voxel 0 lies so many voxels inside the first block
    Place size{};                ///< of the volume
    std::array<double, 3> pitch_mm{};
    ViewingWindow window;
    DirectionSet directions;
    bool mirrored = false;
    Backing backing = Backing::none;
    std::shared_ptr<const Sheet> sheet;  ///< of Backing::sheet
    LateralSpread spread;                ///< of what its cells and their parts hold; core blocks hold their own
    std::size_t resins = 0;
    /// Where resins have indices of their own: the least and the largest, and where each resin's stands between them in
    /// steps, 0 to eta_steps - 1; else empty.
    std::array<double, 2> eta_range{};
    std::vector<float> eta_step;

private:
    [[nodiscard]] Place corner(const Place& at, int cells) const;
};

/// The faces of cells beyond which lies something else, and what they do to light (viewing_faces.h).
struct GridFaces {
    std::vector<OuterFace> faces;  ///< those of a cell in order of `Facing`
    std::vector<FaceLaw> laws;     ///< of faces; 0 lets nothing through
    /// Where resins have indices of their own: so many laws at the set's index, after which they come again for each
    /// step of index; else 0.
    std::size_t laws_of_one = 0;
    std::vector<std::uint32_t> law;         ///< per face
    std::vector<std::uint32_t> core_faces;  ///< outer faces that lead into the core
    std::vector<std::uint32_t> open_faces;  ///< the others: to the light, a sheet or a mirror
    /// Of each outer face among the open ones; `into_core` and among the core's.
    std::vector<std::uint32_t> place_of_face;
    std::vector<FacingFace> by_facing;  ///< the outer faces of each block, ascending in facing

    [[nodiscard]] const FaceLaw& law_of(std::size_t face) const { return laws[law[face]]; }
};

/// What a cell holds: share of its volume by resin and by layer across the light's way, the one nearest to the air
/// first.
struct Holding {
    Material material = 0;
    std::uint8_t layer = 0;
    float share = 0;
};
struct Mixture {
    std::vector<Holding> holds;  ///< ascending in layer, then material
    std::uint8_t axis = 2;       ///< along which light comes
    float apart = 0;             ///< of a part of one resin: the share of its faces behind which another one lies
};

/// Indices that the surface may have between that of one resin and that of another.
inline constexpr std::size_t eta_steps = 9;

/// Of FineBlocks::first: the block is not cut.
inline constexpr std::uint32_t not_fine = 0xffffffffu;

/// Blocks whose cells are cut into parts no larger than voxels (refinement.h). Shape and faces stay those of the cells.
struct FineBlocks {
    Place split{};                      ///< parts of a cell along each axis, a multiple of its voxels; 0: no block
    std::vector<std::uint32_t> first;   ///< first part of each transport block, or `not_fine`
    std::vector<std::uint16_t> medium;  ///< of each part: into `contents`, whose first one is air
    std::vector<Mixture> contents;
    [[nodiscard]] bool any() const { return split[0] > 0; }
    [[nodiscard]] std::size_t parts() const { return product(split); }
    /// Place of a part of cell (x, y, z) of a block among the block's.
    [[nodiscard]] std::size_t part(const Place& cell, const Place& part) const {
        return at3({cell[0] * split[0] + part[0], cell[1] * split[1] + part[1], cell[2] * split[2] + part[2]},
                   {4 * split[0], 4 * split[1], 4 * split[2]});
    }
};

/// What a print has in a grid: made anew for each (homogenisation.h, refinement.h).
struct GridContents {
    std::vector<std::uint16_t> medium;  ///< per cell: into `mixtures`
    std::vector<Mixture> mixtures;      ///< of cells; 0 is air
    FineBlocks fine;
    /// What core nodes hold: m up to the number of resins is resin m - 1 alone, of those beyond each has its shares
    /// here, one a resin.
    std::vector<std::uint32_t> core_medium;
    std::vector<float> core_shares;

    [[nodiscard]] std::size_t cells() const { return medium.size(); }
};

/// Made by viewing_grid_builder.h.
struct ViewingGrid : GridFrame, GridFaces, GridContents {
    ViewingGrid() = default;
    explicit ViewingGrid(GridFrame frame) : GridFrame(std::move(frame)) {}

    /// The solid transport cell in which a voxel counts (cell -1: none), in which of its layers, and its share of the
    /// cell's volume.
    struct Home {
        std::int64_t cell = -1;
        std::uint8_t axis = 2, layer = 0;  ///< as of Mixture
        float share = 0;
    };
    [[nodiscard]] Home home_of(const Place& voxel) const;

    /// The solid transport cell at a place of the viewing grid, or -1.
    [[nodiscard]] std::int64_t cell_of(const Place& at) const;
    /// A cell that is not solid, and the solid one that holds its resin.
    struct Donor {
        std::uint32_t to;  ///< cell
        Place from;        ///< its lowest voxel
    };
    /// Those whose resin this cell holds.
    [[nodiscard]] std::span<const Donor> donors_to(std::uint32_t cell) const;
    /// The outer faces of a cell.
    template <class Body>
    void each_face(std::uint32_t cell, Body&& body) const;
    [[nodiscard]] const GridBlock& transport_block(std::size_t t) const { return blocks[transport_blocks[t]]; }
    /// The only resin of a block in a volume, 0 where there is none, -1 where there are several; and whether there is
    /// air. `box`: room to work in.
    struct Content {
        std::int16_t resin = 0;
        bool any_air = false;
    };
    [[nodiscard]] Content content_of(const GridBlock& block, const ResinVolume& volume,
                                     std::vector<Material>& box) const;
    [[nodiscard]] std::size_t memory_bytes() const;
    /// Frees what the vectors hold in reserve.
    void shrink();
    /// All lists of plain values, of which `mixtures` and `fine` are none.
    template <class Grid, class Body>
    static void each_list(Grid& grid, Body&& body);

    bool mixes_core = false;             ///< else a block of several materials has to have cells
    std::vector<GridBlock> blocks;       ///< ascending in z, y, x
    std::vector<std::int32_t> block_at;  ///< of each lattice place, -1: air
    /// First transport block of each row of blocks along x, with an end mark.
    std::vector<std::uint32_t> transport_rows;
    std::vector<std::uint32_t> transport_blocks;
    std::vector<std::uint8_t> towards;      ///< of each transport block: the facing of the surface near it
    std::vector<std::uint32_t> core_block;  ///< of each core node
    std::vector<std::uint32_t> ghosts;      ///< core nodes on the cut sides of the window, ascending
    std::vector<Donor> donors;              ///< ascending in `to`
    std::vector<std::uint32_t> donors_of;   ///< first donor of each transport block, with an end mark
};

template <class Grid, class Body>
void ViewingGrid::each_list(Grid& grid, Body&& body) {
    const auto each = [&](auto&... lists) { (body(lists), ...); };
    each(grid.blocks, grid.block_at, grid.transport_rows, grid.transport_blocks, grid.medium, grid.faces, grid.laws,
         grid.law, grid.core_block, grid.core_medium, grid.core_shares, grid.ghosts, grid.core_faces, grid.open_faces,
         grid.place_of_face, grid.by_facing, grid.towards, grid.donors, grid.donors_of);
}

template <class Body>
void ViewingGrid::each_face(std::uint32_t cell, Body&& body) const {
    const GridBlock& home = transport_block(cell / 64);
    const auto of_block = std::span(faces).subspan(home.first_face, home.faces);
    for (const OuterFace& face : std::ranges::equal_range(of_block, cell, {}, &OuterFace::cell))
        body(static_cast<std::uint32_t>(&face - faces.data()));
}

}  // namespace voxtone::optics

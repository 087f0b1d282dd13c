// SPDX-License-Identifier: GPL-3.0-or-later
//
// Diffusion of light on a viewing grid, by conjugate gradients with a multigrid preconditioner.
//
//   -div(D grad phi) + sigma_a phi = q,   J = -D grad phi,   D = 1 / (3 (sigma_a + (1 - g) sigma_s))
//
// as finite volumes: for node i  sum_j c_ij (phi_i - phi_j) + l_i phi_i = b_i, with the conductance of a contact of
// area A between half edges h:  c = A / (h_i / D_i + h_j / D_j),  and l_i what is absorbed in the node and leaves
// through outer faces. Lengths in mm; phi is a mean radiance.
//
// A face that lets the share T of diffuse light through has the half-range condition of Marshak 1947 (Phys. Rev.
// 71:443), with one T for phi and for J; Haskell et al. 1994 (J. Opt. Soc. Am. A 11:2727) have a reflectance of its own
// for each. In corrections of a sweep the difference converges away; at nodes of the core that border on air it stays.
//
// The unknowns are the 64 cells of each transport block and one node for each core block. Multigrid: cells, 8 a block,
// then blocks by the sparse rows of multigrid.h. Cells relax by Gauss-Seidel block by block, blocks of even parity
// first, so that threads do not matter; core nodes only on the level of blocks. Work per cycle: about 20 ns of one core
// a cell. Memory: 32 bytes a cell, lent by the caller, and 9 a cell of its own.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/progress.h"
#include "optics/grid/viewing_grid.h"
#include "optics/transport/multigrid.h"

namespace voxtone::optics {

/// Conductances of a block's n^3 cells towards +x, +y and +z, and 1 / (their sum over all six faces and the loss); 0
/// for air.
template <int n>
struct alignas(16) BlockStencil {
    float x[n * n * n] = {}, y[n * n * n] = {}, z[n * n * n] = {}, inverse[n * n * n] = {};
};

class ViewingDiffusion {
public:
    explicit ViewingDiffusion(const ViewingGrid& grid);

    /// Diffusion constants of the media of cells (0 for air) and of core blocks, losses of cells and core nodes;
    /// `blocks` has room for every transport block and is kept by the caller until the next call. Throws Cancelled.
    void prepare(std::span<const float> D_of_medium, std::span<const float> D_of_core, std::span<const float> cell_loss,
                 std::span<const float> core_loss, std::span<BlockStencil<4>> blocks,
                 const Progress* progress = nullptr);
    /// Values of cells and core nodes.
    struct Vector {
        std::span<float> cells, core;
    };
    /// Improves x from A x = b by conjugate gradients until the residual is `tolerance` of the first one or
    /// `most_steps` were made; returns the steps. `residual` comes in as b - A x; it, `p` and `z` are room to work in.
    /// Throws Cancelled.
    int solve(Vector x, Vector residual, Vector p, Vector z, double tolerance, int most_steps,
              const Progress* progress = nullptr);
    /// out = A x.
    void apply(Vector x, Vector out) const;
    /// What flows along +x, +y and +z through the two faces of each cell of transport block t that lie across, in sum,
    /// for these diffusion constants; faces to the air let nothing through.
    using Flows = std::array<std::array<float, 64>, 3>;
    [[nodiscard]] Flows flows(std::size_t t, std::span<const float> D_of_medium, std::span<const float> D_of_core,
                              Vector x) const;
    [[nodiscard]] std::size_t memory_bytes() const;

    /// Where a transport block borders on a core block.
    struct CoreSide {
        std::uint32_t block = 0;  ///< place among the transport blocks
        std::uint32_t core = 0;   ///< node
        std::uint8_t facing = 0;
    };
    /// Contacts of core nodes: pairs, with the axis across.
    struct CoreContact {
        std::uint32_t a = 0, b = 0;
        std::uint8_t axis = 0;
    };
    [[nodiscard]] std::span<const CoreContact> core_contacts() const { return contacts_; }
    /// Conductance from a cell to a core node across a face of this axis, and between core nodes: factors of D1 D2 /
    /// (D1 + D2) for equal halves; see the source for unequal ones.
    [[nodiscard]] float cell_contact(std::size_t axis, float D1, float D2) const {
        const float sum = D1 + D2;  // no branch: rows of contacts are vectors; 0 where either is
        return k_[axis] * D1 * D2 / (sum > 0 ? sum : 1.0f);
    }
    [[nodiscard]] float side_contact(std::size_t axis, float D, float D_core) const {
        return D > 0 ? k_[axis] * D * D_core / (4 * D + D_core) : 0;
    }
    [[nodiscard]] float core_contact(std::size_t axis, float D1, float D2) const {
        return 4 * k_[axis] * D1 * D2 / (D1 + D2);
    }

private:
    /// Conductances of a block's faces towards -x, -y and -z.
    template <int n>
    struct alignas(16) LowSides {
        float x[n * n] = {}, y[n * n] = {}, z[n * n] = {};
    };
    template <int n>
    struct Level;
    void make_fine(std::span<const float> D_of_medium, std::span<const float> D_of_core,
                   std::span<const float> cell_loss, std::span<BlockStencil<4>> blocks);
    void make_middle(std::span<const float> cell_loss);
    void close_middle();
    void make_coarse(std::span<const float> D_of_core, std::span<const float> core_loss);
    /// x = about the solution for b, by one V-cycle from 0.
    void cycle(Vector b, Vector x, const Progress* progress);
    template <int n>
    void relax(const Level<n>& level, std::span<const float> b, std::span<float> x, std::span<const float> core_x,
               bool back) const;
    template <int n, class Body>
    void for_core_flows(const Level<n>& level, std::span<const float> x, std::span<const float> core_x,
                        Body&& body) const;
    template <int n>
    void restrict_to(const Level<n>& level, std::span<const float> b, std::span<const float> x,
                     std::span<const float> core_x, std::span<const float> core_b, std::span<float> coarse_b,
                     std::span<float> coarse_core_b) const;

    const ViewingGrid& grid_;
    std::array<float, 3> k_{};
    std::vector<std::array<std::int32_t, 6>> neighbour_, side_of_;
    std::array<std::vector<std::uint32_t>, 2> parity_;  ///< places among the transport blocks
    std::vector<CoreSide> sides_;
    std::vector<CoreContact> contacts_;
    std::span<const BlockStencil<4>> fine_;
    std::vector<BlockStencil<2>> middle_;
    std::vector<LowSides<4>> fine_low_;
    std::vector<LowSides<2>> middle_low_;
    std::vector<float> fine_side_, middle_side_;  ///< conductances towards the core: 16, 4 a side
    std::vector<float> core_conductance_, core_loss_, middle_loss_;
    std::vector<float> x1_, b1_, core_x1_, core_b1_, x2_, b2_;
    std::unique_ptr<MultigridPlan> plan_;
    std::unique_ptr<Multigrid> blocks_;
};

}  // namespace voxtone::optics

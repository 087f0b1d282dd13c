// SPDX-License-Identifier: GPL-3.0-or-later
//
// Diffusion of light on the nodes of an optical grid, by conjugate gradients with a multigrid preconditioner.
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
// Multigrid: nodes are gathered to 8 a block, 1 a block, then 2 x 2 x 2 blocks and so on; coarse conductances are sums
// of those of the contacts between, times the ratio of the distances (what rediscretising gives); symmetric
// Gauss-Seidel before and after. Work and memory are linear in the number of nodes. Deterministic.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "voxtone/base/progress.h"
#include "voxtone/optics/transport/optical_grid.h"

namespace voxtone::optics {

/// The pattern of the equations: the same for all channels.
class DiffusionPlan {
public:
    /// Throws Cancelled.
    explicit DiffusionPlan(const OpticalGrid& grid, const Progress* progress = nullptr);
    struct Contact {
        std::uint32_t a, b;
        friend auto operator<=>(const Contact&, const Contact&) = default;
    };
    /// For nodes at these places, which are apart by 1 or more, and contacts between them.
    DiffusionPlan(std::vector<std::array<float, 3>> centre, std::span<const Contact> contacts);

    struct Level {
        std::vector<std::uint32_t> row, column;  ///< neighbours of node i: column[row[i]] .. column[row[i + 1] - 1]
        std::vector<std::uint32_t> parent;       ///< of each node, on the next level; empty on the last
        /// Finer level's contact (row entry) -> entry here, or `none` where both ends have one parent; and its ratio.
        std::vector<std::uint32_t> gathered;
        std::vector<float> ratio;
        [[nodiscard]] std::size_t nodes() const { return row.size() - 1; }
    };
    static constexpr std::uint32_t none = 0xffffffffu;
    std::vector<Level> levels;
    std::vector<std::vector<std::uint32_t>> twins;  ///< of level l + 1: the entry of the same contact in the other row
    std::vector<std::uint32_t> entry_ab, entry_ba;  ///< of each contact of the grid, on level 0
    [[nodiscard]] std::size_t memory_bytes() const;

private:
    void gather_levels(std::vector<std::array<float, 3>> centre, const Progress* progress);
};

class Diffusion {
public:
    /// `conductance` per contact of the grid, `loss` per node.
    Diffusion(const DiffusionPlan& plan, std::span<const float> conductance, std::span<const float> loss);

    /// Improves `x` until the residual is `tolerance` of the first one (in the norm of its preconditioner) or
    /// `most_steps` were made; returns the steps. Throws Cancelled.
    int solve(std::span<const float> right_side, std::span<float> x, double tolerance, int most_steps,
              const Progress* progress = nullptr) const;
    /// x: roughly the solution for this right side, by one V-cycle.
    void precondition(std::span<const float> right_side, std::span<float> x, const Progress* progress = nullptr) const {
        cycle(0, right_side, x, progress);
    }
    [[nodiscard]] std::size_t memory_bytes() const;

private:
    struct Values {
        std::vector<float> c;              ///< per entry
        std::vector<float> inverse, loss;  ///< 1 / diagonal
    };
    void cycle(std::size_t level, std::span<const float> b, std::span<float> x, const Progress* progress) const;
    void apply(std::span<const float> x, std::span<float> out) const;

    const DiffusionPlan& plan_;
    std::vector<Values> values_;
    mutable std::vector<std::vector<float>> b_, x_;  ///< of the coarse levels
};

}  // namespace voxtone::optics

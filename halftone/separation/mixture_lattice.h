// SPDX-License-Identifier: GPL-3.0-or-later
//
// The lattice of a separation (separation.h has its equation): at each node the mixture whose appearance is nearest to
// the node's colour. Nodes are solved when they are first asked for, so that a body of few colours costs few of them.
//
// A node starts from its neighbour of more red, the row's last from a fixed mixture: to solve one solves all of its row
// with more red. What a node holds depends on nothing else: the same bits whoever asks, in any order, from any thread.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "halftone/separation/appearance_colour.h"
#include "halftone/separation/invert_appearance.h"
#include "halftone/separation/lattice_view.h"
#include "halftone/separation/made_on_demand.h"
#include "halftone/separation/mixture.h"
#include "halftone/separation/separation_options.h"

namespace voxtone::halftone {

class MixtureLattice final : private LatticeSolver {
public:
    using Roots = std::array<float, max_resins>;

    /// `colour` must outlive this. Throws UsageError for options out of range.
    MixtureLattice(const AppearanceColour& colour, const SeparationOptions& options);
    MixtureLattice(const MixtureLattice&) = delete;
    MixtureLattice& operator=(const MixtureLattice&) = delete;

    /// Nodes of the cube: red fastest.
    [[nodiscard]] std::size_t nodes() const { return root_.size(); }
    /// Square roots of a node's fractions; 0 beyond the last resin.
    [[nodiscard]] const Roots& at(std::size_t node);
    /// For look-ups, which solve what they meet.
    [[nodiscard]] LatticeView view();

private:
    /// Nodes from `first_solved` on stand; the next one starts from `guess`.
    struct Row {
        std::size_t first_solved;
        Unknowns guess;
    };
    struct alignas(32) Node {
        Roots root{};
    };

    void solve(std::size_t node) override;
    void solve_next(std::size_t row);

    const AppearanceColour& colour_;
    SeparationOptions options_;
    std::size_t size_;  ///< nodes along an axis
    Unknowns penalty_;
    Node white_;
    std::vector<Node> root_;
    std::vector<Row> rows_;
    MadeOnDemand solved_;
};

}  // namespace voxtone::halftone

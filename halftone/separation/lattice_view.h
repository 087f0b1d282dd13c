// SPDX-License-Identifier: GPL-3.0-or-later
//
// A lattice of mixtures over the colour cube, as its look-up reads it (lattice_lookup.h). Its nodes may be solved only
// when a colour next to them is looked up.
#pragma once

#include <cstddef>

#include "halftone/separation/made_on_demand.h"

namespace voxtone::halftone {

/// Solves a node and marks it; from any thread.
class LatticeSolver {
public:
    virtual void solve(std::size_t node) = 0;

protected:
    ~LatticeSolver() = default;
};

/// Nodes are even in the cube root of each channel, red fastest.
struct LatticeView {
    const float* root;  ///< nodes^3 times max_resins square roots of shares
    int nodes;          ///< along each axis, in [2, 65]
    int resins;
    const MadeOnDemand* solved = nullptr;  ///< null: all nodes are
    LatticeSolver* solver = nullptr;       ///< of the others
};

/// Before a node's roots are read.
inline void require_node(const LatticeView& lattice, std::size_t node) {
    if (lattice.solved && !lattice.solved->made(node)) lattice.solver->solve(node);
}

}  // namespace voxtone::halftone

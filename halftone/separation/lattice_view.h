// SPDX-License-Identifier: GPL-3.0-or-later
//
// A lattice of mixtures over the colour cube, as its look-up reads it (lattice_lookup.h).
#pragma once

namespace voxtone::halftone {

/// Nodes are even in the cube root of each channel, red fastest.
struct LatticeView {
    const float* root;  ///< nodes^3 times max_resins square roots of shares
    int nodes;          ///< along each axis, in [2, 65]
    int resins;
};

}  // namespace voxtone::halftone

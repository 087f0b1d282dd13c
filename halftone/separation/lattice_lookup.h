// SPDX-License-Identifier: GPL-3.0-or-later
//
// The hot loop of the separation: tetrahedral interpolation in a lattice of mixtures, for many colours. Vector code
// with run-time dispatch, without fused operations, so that every target gives the same bits: those of
// scalar_lookup.h, which says what is computed.
#pragma once

#include <cstddef>

#include "halftone/separation/lattice_view.h"
#include "halftone/separation/mixture.h"

namespace voxtone::halftone {

/// Shares of one colour, max_resins of them; their sum is near 1. Channels outside [0, 1] are clamped, NaN is 0.
void lattice_shares(const LatticeView& lattice, float red, float green, float blue, float* shares);

/// Mixtures of n colours.
void lattice_mixtures(const LatticeView& lattice, const float* red, const float* green, const float* blue,
                      std::size_t n, CumulativeMixture* out);

}  // namespace voxtone::halftone

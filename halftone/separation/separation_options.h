// SPDX-License-Identifier: GPL-3.0-or-later
//
// How a separation is made; separation.h has the equation that these stand in.
#pragma once

#include "optics/colour/channels.h"

namespace voxtone::halftone {

struct SeparationOptions {
    int nodes = 41;               ///< lattice nodes along each axis, in [2, 65]
    double ink_penalty = 1e-4;    ///< lambda, in units where Oklab's L runs from 0 to 1; > 0
    double clear_penalty = 1e-2;  ///< the same for resins that neither absorb nor scatter; > 0
    optics::Channels channels;    ///< what the appearance's channels are
    double lightness_weight = 1.0, chroma_weight = 0.7, hue_weight = 4.0;  ///< of W; > 0
};

}  // namespace voxtone::halftone

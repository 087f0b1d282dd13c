// SPDX-License-Identifier: GPL-3.0-or-later
//
// Between the islands of an atlas lies a background (black, often). Bilinear taps and minification at an island's
// border would pull it in as dark seams. So texels that no triangle uses take the value of the nearest used texel
// before the levels are made.
//
// Based on: A. Meijster, J. Roerdink, W. Hesselink, "A general algorithm for computing distance transforms in linear
// time", 2000: nearest in the column first, then the lower envelope of parabolas along each row; exact.
#pragma once

#include "io/models/texel_coverage.h"

namespace voxtone::io {

/// Gives every unused texel the colour and alpha of the used texel with the nearest centre (Euclidean, in texels).
/// Nothing changes when no texel is used.
void fill_gutters(TexelImage& image, const TexelCoverage& coverage);

}  // namespace voxtone::io

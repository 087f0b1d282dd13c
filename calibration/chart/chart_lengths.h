// SPDX-License-Identifier: GPL-3.0-or-later
//
// Millimetres for a fit of thick mixtures, whose colours tell absorption and other resins' scattering relative to the
// scattering of white alone: that of another set's white, channel by channel. A channel scatters as the other set's
// channels of the same light do: mean of their reduced scattering sigma_s (1 - g) by how much of the eye's white they
// share, channels being compared by their weights in linear sRGB.
#pragma once

#include <vector>

#include "optics/media/resins.h"

namespace voxtone::calibration {

/// sigma_s per mm of white in each of `channels` for light that scatters with mean cosine g. Throws InputError where
/// `from` has no resin W.
[[nodiscard]] std::vector<double> white_scattering(const optics::Channels& channels, double g,
                                                   const optics::ResinSet& from);

}  // namespace voxtone::calibration

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The light of a proof from far away: one that comes with the program, or a lat-long picture of a place.
#pragma once

#include "base/progress.h"
#include "optics/camera/sky.h"
#include "slicer/proof/proof_options.h"

namespace voxtone::slicer {

/// Normalised: a white diffuser that lies in the open has 1. Lat-long pictures have the zenith in their first row and
/// are twice as wide as high; their middle column lies behind the camera of the front view (-y), as if one stood at the
/// print and looked at the camera. Those of codes (PNG, JPEG) count as sRGB, with a warning: their brightest places are
/// cut off. Of a beam nothing is asked here: even light. Throws FileError, InputError, Cancelled.
[[nodiscard]] optics::Sky light_of(const ProofLamp& lamp, double turn_deg, Progress& progress);

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
//
// How diffuse light gets out of a flat face of resin that lies on a black sheet, and how deep the sheet is out of
// sight.
#pragma once

#include "optics/grid/transport_directions.h"
#include "optics/media/resins.h"

namespace voxtone::optics {

/// phi / J of diffuse light, both as radiance, where resin lies on a black sheet, air between. The flat surface lets
/// the share T of what phi sends out through, and U of what J adds to it: J = T phi / 4 + U J / 2, phi / J = (4 - 2 U)
/// / T (Haskell et al. 1994, J. Opt. Soc. Am. A 11:2727). So near a surface light is no longer phi + 3 Omega . J:
/// without mirroring the exact figure is 1.066 of that (Milne's problem), and slabs of white, yellow and magenta of
/// index 1.5 agree with adding-doubling at 0.95 of it, and are up to 0.0013, 0.004 and 0.0015 too light without;
/// between by T, and on for higher indices, which nothing has checked.
[[nodiscard]] double way_into_sheet(const DirectionSet& set);

/// T there.
[[nodiscard]] double let_out_of_diffuse(const DirectionSet& set);

/// How thick a slab of this resin has to be for a way into the sheet that is a tenth too long to change no channel's
/// appearance by more than 0.001; a great length where none is. By diffusion in one dimension: with the admittance y =
/// J / phi, D mu (y + D mu t) / (D mu + y t) through a thickness d, t = tanh(mu d), mu the decay of diffuse light.
[[nodiscard]] double sheet_depth_mm(const ResinSet& set, const Resin& resin, const DirectionSet& directions);

}  // namespace voxtone::optics

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Prints of layers that show how light spreads (`--show layered-profile`), as jobs know them (part/other_print.h).
#pragma once

namespace voxtone::scattering {

/// From here on jobs may ask for them.
void register_layered_profiles();

}  // namespace voxtone::scattering

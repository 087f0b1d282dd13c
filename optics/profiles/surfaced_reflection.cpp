// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/optics/profiles/surfaced_reflection.h"

#include "voxtone/optics/profiles/resin_profile.h"

namespace voxtone::optics {

double turned_back_share(double eta) { return smooth_surface(eta, 1).R_bottom[0]; }

}  // namespace voxtone::optics

// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/profiles/saunderson.h"

#include "optics/profiles/resin_profile.h"

namespace voxtone::optics {

double internal_diffuse_reflectance(double eta) { return smooth_surface(eta, 1).R_bottom[0]; }

}  // namespace voxtone::optics

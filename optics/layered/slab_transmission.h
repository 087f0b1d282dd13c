// SPDX-License-Identifier: GPL-3.0-or-later
//
// What of light from behind comes through a slab with smooth faces in air, by the modes of its layer (layer_modes.h):
// as spectrophotometers with a sphere read it, against the open port.
//
//   diffuse   uniform light from all sides in, all light out
//   beam      a beam straight through, all light out, the straight one too; by reciprocity the radiance along the
//             normal where uniform light of radiance 1 lies behind
//
// Units mm, mm^-1. What no medium dims lets the surfaces' share through: (1 - r) / (1 + r) of a beam. What it cannot
// see: light that leaves at the slab's rim, rough faces, a port narrower than light spreads.
#pragma once

#include "optics/layered/layer_modes.h"

namespace voxtone::optics {

enum class LightThrough { diffuse, beam };

/// Share of the light that falls on the lower face. `plan` looks along the normal (directional_plan).
[[nodiscard]] double slab_transmission(const OrdinatePlan& plan, const Medium& medium, double thickness_mm,
                                       LightThrough light);

/// The same with derivatives by sigma_a and sigma_s, mm, by differences: 1e-5 of the largest.
struct SlabTransmission {
    double value = 0;
    Medium by;
};
[[nodiscard]] SlabTransmission slab_transmission_slopes(const OrdinatePlan& plan, const Medium& medium,
                                                        double thickness_mm, LightThrough light);

}  // namespace voxtone::optics

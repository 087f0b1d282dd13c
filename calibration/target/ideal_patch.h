// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a patch of known resins reflects: rho(45 -> 0) of a square upon its base by adding-doubling
// (optics/layered/directional.h), mixtures taken as ideal (Iser, Rittig, Wilkie 2025, Eq. 7), of infinite width. Under
// a base of finite thickness lies a perfect absorber of the same refractive index: the dark sheet that a target is
// photographed upon.
//
// The plain reference: a few ms per value. Error below 1e-5. Cannot see: that a printed mixture is a dither of voxels,
// and what a neighbour's light adds near an edge.
#pragma once

#include <string>
#include <vector>

#include "calibration/patches/patch_table.h"
#include "calibration/target/target_layout.h"
#include "optics/layered/adding_doubling.h"

namespace voxtone::calibration {

class IdealPatches {
public:
    explicit IdealPatches(const optics::ResinSet& set);

    /// Per channel. `base_mm` 0: a base without end. Throws InputError where the set lacks a resin.
    [[nodiscard]] std::vector<double> reflectance(const PatchMixture& top, double top_mm, const std::string& backing,
                                                  double base_mm) const;
    /// Of all squares of a target.
    [[nodiscard]] std::vector<std::vector<double>> squares(const Target& target) const;

private:
    [[nodiscard]] std::vector<double> fractions(const PatchMixture& mixture) const;

    optics::ResinSet set_;
    optics::AddingDoubling solver_;
};

/// How much darker this much of a resin is over black than without end, per channel; a base that is to count as opaque
/// has nothing much here.
[[nodiscard]] std::vector<double> lost_through_base(const optics::ResinSet& set, const std::string& role,
                                                    double base_mm);

}  // namespace voxtone::calibration

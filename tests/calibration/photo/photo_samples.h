// SPDX-License-Identifier: GPL-3.0-or-later
//
// Targets and photographs that several tests look at.
#pragma once

#include "calibration/photo/photo_measurement.h"
#include "calibration/rehearsal/photo_simulation.h"
#include "calibration/target/target_layout.h"

namespace voxtone::calibration::testing {

/// Of the voxels of a Stratasys J750, High Mix.
inline TargetOptions target_options(TargetLayout layout, std::vector<std::string> roles = {"C", "M", "Y", "K", "W"}) {
    TargetOptions options;
    options.layout = layout;
    options.roles = std::move(roles);
    options.printer = "stratasys-j750-hm";
    options.pitch_um = {25400.0 / 600, 25400.0 / 300, 27};
    return options;
}

inline Target target_of(TargetLayout layout, std::vector<std::string> roles = {"C", "M", "Y", "K", "W"}) {
    return lay_out_target(target_options(layout, std::move(roles)));
}

/// Vero as Elek et al. measured it, and a set that differs from it in every value.
inline optics::ResinSet changed_vero() {
    optics::ResinSet set = optics::vero_opaque();
    set.name = "vero-changed";
    double step = 0;
    for (optics::Resin& resin : set.resins)
        for (std::size_t channel = 0; channel < 3; ++channel) {
            step += 1;
            resin.sigma_t_per_mm[channel] *= 1 + 0.2 * std::sin(step);
            resin.albedo[channel] = std::pow(resin.albedo[channel], 1 + 0.2 * std::cos(2 * step));
        }
    return set;
}

/// The photograph's largest distance from the truth.
inline double worst_error(const std::vector<Eigen::Vector3d>& rho, const TargetColours& truth) {
    double worst = 0;
    for (std::size_t s = 0; s < rho.size(); ++s)
        worst = std::max(worst, (rho[s] - truth.squares[s]).cwiseAbs().maxCoeff());
    return worst;
}

}  // namespace voxtone::calibration::testing

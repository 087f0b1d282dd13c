// SPDX-License-Identifier: GPL-3.0-or-later
//
// The bench on which edge fits are rehearsed, which is not the one that their setup says: values divided by 0.913,
// slabs 2 % thicker than said, 0.045 and 0.015 mm of gel in place of 0.03 and 0.03, blur of one pixel, noise of 0.001.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "calibration/edge/edge_fit.h"
#include "calibration/rehearsal/edge_simulation_job.h"

namespace voxtone::calibration::rehearsal {

inline constexpr double bias = 0.913;

/// What a fit is told of the bench. `level_error`: of a photograph's white point and of the renderer together.
[[nodiscard]] EdgeSetup assumed_setup(double level_error = 0.003);
/// Profiles of resins on the bench, rendered path by path.
[[nodiscard]] std::vector<EdgeProfile> measured(const optics::ResinSet& set, std::uint32_t paths, std::uint64_t seed);
/// Of a file, or traced for these thicknesses and g: 24 extinctions from 0.5 to 48 per mm.
[[nodiscard]] std::shared_ptr<const EdgeDictionary> dictionary(const std::string& file, const std::vector<double>& g,
                                                               std::uint32_t paths,
                                                               const std::vector<double>& thickness_mm = {0.5, 1});

}  // namespace voxtone::calibration::rehearsal

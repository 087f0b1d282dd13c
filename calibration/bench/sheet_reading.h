// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the photograph of the bare sheet says of it: how its white and black look, how soft its edge is, and how much
// light the diffuse base under its surface reflects, which is what setup.json wants.
//
// A base of reflectance R under the surface of the setup looks F(R) bright (optics/edge/edge_response.h, far from the
// edge); a sheet without a slab is a slab of air. F grows with R, so it is inverted by bisection.
#pragma once

#include <array>

#include "calibration/bench/edge_strip.h"
#include "calibration/edge/edge_setup.h"

namespace voxtone::calibration {

struct SheetReading {
    std::array<double, 3> seen_white{}, seen_black{};  ///< as the photograph has them
    EdgeBlur edge;
};

/// Reflectances of the base under the setup's surface.
struct SheetBase {
    std::array<double, 3> white{}, black{};
    std::array<bool, 3> too_bright{};  ///< no base is so bright: white is the largest that a setup may say
};

/// Throws InputError where there is no edge, or it is too soft.
[[nodiscard]] SheetReading read_sheet(const EdgeStrip& strip, const std::string& name);

/// How the sheet's base looks without a slab, by kernels of the setup's surface: seconds.
[[nodiscard]] optics::EdgeKernels bare_sheet_kernels(const EdgeSetup& setup);
[[nodiscard]] SheetBase base_under_surface(const SheetReading& sheet, const optics::EdgeKernels& kernels);

}  // namespace voxtone::calibration

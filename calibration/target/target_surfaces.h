// SPDX-License-Identifier: GPL-3.0-or-later
//
// A target upon surfaces that were there before, such as a card half white and half black (patch_surfaces.h): nothing
// is printed but its squares and the dark cells of its markers. Where there is no white resin to dilute colours, pure
// squares in three thicknesses stand for mixtures (tests/calibration/fit/surface_fit_test.cpp).
#pragma once

#include <memory>
#include <string_view>

#include "calibration/patches/patch_surfaces.h"
#include "calibration/target/target_layout.h"

namespace voxtone::calibration {

/// "white=smooth:0.85" or "white=smooth+gap:0.85,0.84,0.8": name, kind, what it reflects bare, in linear R, G, B.
/// Throws InputError.
[[nodiscard]] std::shared_ptr<const PatchSurface> parse_target_surface(std::string_view text);

/// The patch that a square is, without values.
[[nodiscard]] Patch patch_of(const Target& target, const TargetSquare& square);

/// Of the target's surfaces; contract: it is there.
[[nodiscard]] Eigen::Vector3d rgb_of(const Target& target, std::string_view surface);

}  // namespace voxtone::calibration

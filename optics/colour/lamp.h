// SPDX-License-Identifier: GPL-3.0-or-later
//
// Light that a print is looked at by, and its colours under it.
//
//   XYZ = sum_l P(l) (xbar, ybar, zbar)(l) rho(l) / sum_l P(l) ybar(l)       P: relative spectral power of the lamp
//
// What an eye that is used to the lamp sees is told as the colour that looks the same under D65, so that it can be
// shown beside what was asked for on a screen: the lamp's white becomes D65's by Bradford's transform, adaptation
// complete (colour.h, as everywhere here). Surfaces of one colour under D65 may differ under the lamp: metamerism.
//
// Lamps by name: CIE 15:2018 (A, D50, D65, FL2, FL11, LED-B1, LED-B3; sources in lamp.cpp), and black bodies by
// Planck's law, c2 = 0.014388 m K (CIE 15:2018, 3.1).
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "optics/colour/channels.h"

namespace voxtone::optics {

inline constexpr std::size_t lamp_samples = 81;  ///< 380 to 780 nm in steps of 5 nm
inline constexpr double lamp_first_nm = 380, lamp_step_nm = 5;

/// Relative spectral power, of any scale: not negative, not 0 everywhere that an eye sees.
using LampPower = std::array<double, lamp_samples>;

/// Of a lamp that comes with the program, "F11", or of a black body, "2700K" (500 to 100,000 K); capitals do not
/// matter. Nothing for other words.
[[nodiscard]] std::optional<LampPower> known_lamp(std::string_view name);
/// "A", "D50", ..., in the order of CIE 15.
[[nodiscard]] std::vector<std::string> lamp_names();

[[nodiscard]] LampPower black_body(double kelvin);

/// Of a lamp that was measured at these wavelengths, nm, rising: between them linear where they are more than 5 nm
/// apart; finer ones are gathered by triangles 5 nm wide at half of their height, by which narrow lines keep their
/// power. Beyond the first and last: none.
[[nodiscard]] LampPower sampled_lamp(std::span<const double> wavelengths_nm, std::span<const double> power);

/// As xyz_weights (spectral_colour.h) has them under an illuminant.
[[nodiscard]] Eigen::Matrix3Xd xyz_weights(std::span<const double> wavelengths_nm, const LampPower& power);

/// Colours that are known under one light alone: XYZ under `power` = M XYZ under the illuminant, of the reflectance
/// whose slope is least among those of that colour (sum of squared differences of neighbours; S. A. Burns, Color Res.
/// Appl. 45:8, 2020, has it as LSS), white going to white. A guess: of the CIE's 99 test colours (CIE 224:2017) it is
/// off by 0.8 (LED-B3) to 2.0 (LED-B1) CIEDE2000 on average, from D50, where the colour as it is under D50 is off
/// by 2.0 to 4.2; surfaces of one colour stay of one colour.
[[nodiscard]] Eigen::Matrix3d guessed_colours(Illuminant illuminant, const LampPower& power);

/// Channels as they are seen under a lamp: channels of their own with weights to XYZ under D65, adapted. Of wavelengths
/// as they are; of others `guessed_colours`.
[[nodiscard]] Channels seen_under(const Channels& channels, const LampPower& power);

}  // namespace voxtone::optics

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Channels of light, and the observer that makes a colour of their values:
//
//   XYZ = sum_c w_c rho_c,     sum_c w_c = XYZ of the illuminant's white: a perfect diffuser (rho = 1) is white
//
// Three kinds. R, G, B: rho is linear sRGB. Wavelengths: rho is a spectrum, w the CIE 1931 observer under D65
// (spectral_colour.h). Channels of a printer's own: bands without a name, whose weights were fitted together with the
// resins; they may be any light that the eye cannot tell from the real one. A weight may be negative.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "optics/colour/spectral_colour.h"

namespace voxtone::optics {

/// Most channels of a printer's own.
inline constexpr std::size_t max_own_channels = 32;

struct Channels {
    std::vector<double> wavelengths_nm;           ///< nm, rising; empty: R, G, B or a printer's own
    std::vector<std::array<double, 3>> xyz = {};  ///< w_c of a printer's own channels; empty: R, G, B or wavelengths
    Illuminant illuminant = Illuminant::d50;      ///< of `xyz`; without meaning for the others

    [[nodiscard]] bool is_rgb() const { return wavelengths_nm.empty() && xyz.empty(); }
    [[nodiscard]] bool is_spectral() const { return !wavelengths_nm.empty(); }
    [[nodiscard]] bool is_own() const { return !xyz.empty(); }
    [[nodiscard]] std::size_t size() const { return is_rgb() ? 3 : is_own() ? xyz.size() : wavelengths_nm.size(); }
    friend bool operator==(const Channels&, const Channels&) = default;
};

/// What is wrong with them: wavelengths that do not rise, too many channels, weights that make no white (sums farther
/// than 1e-4 from the illuminant's); nothing where all is well.
[[nodiscard]] std::optional<std::string> fault_of(const Channels& channels);

/// X, Y and Z themselves, each relative to the white: what a colorimeter measures.
[[nodiscard]] Channels colorimetric_channels(Illuminant illuminant);

/// R, G and B of primaries so wide that no ink is negative in them: ROMM RGB, ISO 22028-2, x, y of (0.7347, 0.2653),
/// (0.1596, 0.8404), (0.0366, 0.0001), white D50.
[[nodiscard]] const Channels& wide_channels();

/// "R", "450 nm" or "channel 2" (from 1).
[[nodiscard]] std::string channel_name(const Channels& channels, std::size_t channel);
/// The same in a word, for columns and files: "R", "450nm" or "c2".
[[nodiscard]] std::string channel_word(const Channels& channels, std::size_t channel);
/// "R, G, B", "31 wavelengths from 400 to 700 nm" or "4 channels of their own".
[[nodiscard]] std::string channels_text(const Channels& channels);

/// Columns M_c with linear sRGB = M rho: white, adapted to D65 (Bradford), is (1, 1, 1). R, G, B: the identity.
[[nodiscard]] Eigen::Matrix3Xd linear_srgb_weights(const Channels& channels);
/// From XYZ under another white to linear sRGB, adapted (Bradford).
[[nodiscard]] Eigen::Matrix3d linear_srgb_of(const Eigen::Vector3d& white);
/// Columns with CIE XYZ under D65 = W rho, adapted (Bradford); white has d65_white().
[[nodiscard]] Eigen::Matrix3Xd d65_weights(const Channels& channels);

/// The white of an illuminant as XYZ of measuring programs has it: D50 of ICC profiles, D65 of sRGB, A of CIE 15.
[[nodiscard]] Eigen::Vector3d colorimetric_white(Illuminant illuminant);

}  // namespace voxtone::optics

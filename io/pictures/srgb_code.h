// SPDX-License-Identifier: GPL-3.0-or-later
//
// The codes of 8-bit sRGB pixels, by tables of `optics::srgb_decode`; codes and linear values in [0, 1].
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

namespace voxtone::io {

[[nodiscard]] float srgb_to_linear(float code);
[[nodiscard]] Eigen::Vector3f srgb_to_linear(const Eigen::Vector3f& code);

/// Linear value of each 8-bit code.
[[nodiscard]] const std::array<float, 256>& srgb8_to_linear();

/// The 8-bit code nearest to the linear value (nearest in code, not in light); values outside [0, 1] and NaN are
/// clamped.
[[nodiscard]] std::uint8_t linear_to_srgb8(float linear);

}  // namespace voxtone::io

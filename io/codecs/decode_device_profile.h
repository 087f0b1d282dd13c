// SPDX-License-Identifier: GPL-3.0-or-later
//
// A device's ICC profile in this process (io/profiles/device_profile.h reads in another one).
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "io/profiles/device_profile.h"

namespace voxtone::io {

/// `samples`: of as many channels as the profile has, values from 0 to 1; none: what the profile says of itself alone.
/// Colours are evaluated in floating point, so that nothing is rounded but by the table. Throws InputError.
[[nodiscard]] DeviceProfile decode_device_profile(std::span<const std::byte> bytes, std::string name,
                                                  std::span<const double> samples);

}  // namespace voxtone::io

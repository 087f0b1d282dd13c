// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

namespace voxtone::io {

/// A colour of a bitmap, as stored.
using Rgb = std::array<std::uint8_t, 3>;

}  // namespace voxtone::io

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace voxtone::halftone {

/// What tools/make_screen wrote while building: the tiles of built_in_screens.h one after the other, x innermost.
[[nodiscard]] const std::uint16_t* screen_data();

}  // namespace voxtone::halftone

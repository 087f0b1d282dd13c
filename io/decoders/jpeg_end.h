// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

namespace voxtone::io {

/// Whether a JPEG goes on to its end mark (ITU T.81, B.1.1): where it does not, rows are missing, and libjpeg shows
/// grey in their place. Bytes behind the mark do not count; marks in thumbnails are none of its own.
[[nodiscard]] bool jpeg_has_its_end(std::span<const std::byte> bytes);

}  // namespace voxtone::io

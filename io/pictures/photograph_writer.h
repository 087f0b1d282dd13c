// SPDX-License-Identifier: GPL-3.0-or-later
//
// Photographs out: what stands in for a camera writes files as a camera would.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/pictures/photograph.h"

namespace voxtone::io {

/// The bytes of a file of the kind that the name's extension tells: .png or .tif (16 bits, linear; a PNG says so, TIFF
/// has no word for it), .exr (float). The time of exposure is written to .exr. With `bits` 8: .png of sRGB codes.
/// Throws UsageError for other extensions.
[[nodiscard]] std::vector<std::uint8_t> photograph_bytes(const Photograph& photograph, const std::string& file_name);

}  // namespace voxtone::io

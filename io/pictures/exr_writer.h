// SPDX-License-Identifier: GPL-3.0-or-later
//
// OpenEXR of a picture in linear light, for those who measure it: 32-bit float R, G, B, A, losslessly compressed (ZIP),
// with the chromaticities of sRGB. As the format has it, colour is multiplied by the coverage (A).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "io/pictures/picture_writer.h"

namespace voxtone::io {

/// The bytes of the file; with the density of its pixels where px_per_mm is not 0. The same picture gives the same
/// bytes.
[[nodiscard]] std::vector<std::uint8_t> exr_bytes(const LinearPicture& picture,
                                                  std::array<double, 2> px_per_mm = {0, 0});

/// A picture of numbers: rows from the top, `names.size()` values a pixel.
struct NumberPicture {
    std::uint32_t width_px = 0, height_px = 0;
    std::vector<std::string> names;  ///< of the channels, all different: "R", "450nm", "error.R"
    std::vector<float> values;
};

/// The same kind of file with channels of these names; values are written as they are. With a comment (the attribute
/// "comments") where it is not empty.
[[nodiscard]] std::vector<std::uint8_t> exr_bytes(const NumberPicture& picture,
                                                  std::array<double, 2> px_per_mm = {0, 0},
                                                  const std::string& comment = {});

}  // namespace voxtone::io

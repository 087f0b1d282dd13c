// SPDX-License-Identifier: GPL-3.0-or-later
//
// Samples that are not in the range of their type: codes of 0 to 255 (or 65535) in floating point, 8 bits in 16, as
// programs write them that convert and do not scale. Taken at their word such a picture is white or black all over.
//
// Floating point of whole numbers, some of them 32 or more, is codes: light is no whole number throughout. 16 bits of
// which none is above 255, and some are 16 or more, are 8 bits. That is said. Where no such rule holds and every sample
// is brighter than white the picture is refused; where all is black but for numbers below 1/16, that is said.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/decoders/picture_colours.h"

namespace voxtone::io {

/// RGBA of a picture, one of the three kinds, with what is said of it.
struct RawSamples {
    std::vector<std::uint8_t>& bytes;
    std::vector<std::uint16_t>& words;
    std::vector<float>& floats;
    PictureCurve& curve;
    std::vector<std::string>& warnings;
};

/// Makes codes of samples that are. `name` is for messages. Throws InputError.
void mend_sample_range(const RawSamples& samples, const std::string& name);

}  // namespace voxtone::io

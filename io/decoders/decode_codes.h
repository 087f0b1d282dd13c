// SPDX-License-Identifier: GPL-3.0-or-later
//
// Codes in a picture, by ZXing-C++: what voxtone-read does when it is asked (io/pictures/codes_in_picture.h).
#pragma once

#include <vector>

#include "io/pictures/codes_in_picture.h"

namespace voxtone::io {

/// Throws InputError for a picture that is not of its size.
[[nodiscard]] std::vector<CodeInPicture> decode_codes(const LuminanceRaster& picture, int most_times);

}  // namespace voxtone::io

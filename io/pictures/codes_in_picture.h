// SPDX-License-Identifier: GPL-3.0-or-later
//
// Codes that a scanner reads in a picture: QR, Data Matrix, PDF417, Code 128, EAN-13, EAN-8 and UPC-A, all of which
// have sums by which a decoder knows that it has read right, and Code 39 of four characters or more. Read by ZXing-C++
// in voxtone-read, behind its walls: what stands in a code is somebody else's data.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "base/progress.h"
#include "io/files/packed_values.h"

namespace voxtone::io {

/// Rows from the top, sRGB codes of luminance.
struct LuminanceRaster {
    int columns = 0, rows = 0;
    std::vector<std::uint8_t> grey;
};

struct CodeInPicture {
    std::string kind;             ///< "QR code"
    std::string content;          ///< bytes, as they are; of a mirrored one, which no scanner takes, nothing comes
    std::array<double, 4> box{};  ///< left, top, right, bottom, pixels
    double module = 0;            ///< of EAN and UPC, pixels; 0: not known
};

template <class Stream, class Code>
requires std::is_same_v<std::remove_const_t<Code>, CodeInPicture>
void describe(Stream& stream, Code& code) { stream(code.kind, code.content, code.box, code.module); }

/// All that a patient reader finds: from several distances (the picture is enlarged up to `most_times`, at most 6, and
/// to four million pixels), by a threshold of the whole and one of each neighbourhood. Throws FileError (no
/// voxtone-read), TryAgain, InputError where reading came to an end that no code should bring about.
[[nodiscard]] std::vector<CodeInPicture> codes_in_picture(const LuminanceRaster& picture, int most_times = 6,
                                                          const Progress* progress = nullptr);

}  // namespace voxtone::io

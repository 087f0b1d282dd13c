// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/decoders/jpeg_end.h"

#include <cstdint>

namespace voxtone::io {

namespace {

enum JpegMark : std::uint8_t {
    jpeg_stuffed = 0x00,
    jpeg_temporary = 0x01,
    jpeg_first_restart = 0xd0,
    jpeg_start = 0xd8,
    jpeg_end = 0xd9,
    jpeg_fill = 0xff,
};

/// Marks that no segment with a length follows: those amid the codes of a scan, too.
bool stands_alone(std::uint8_t mark) {
    return mark == jpeg_stuffed || mark == jpeg_temporary || (mark >= jpeg_first_restart && mark <= jpeg_start);
}

}  // namespace

bool jpeg_has_its_end(std::span<const std::byte> bytes) {
    const auto at = [&](std::size_t i) { return std::to_integer<std::uint8_t>(bytes[i]); };
    for (std::size_t i = 0; i + 1 < bytes.size();) {
        if (at(i) != 0xff || at(i + 1) == jpeg_fill) {
            ++i;  // a code of a scan, or padding
            continue;
        }
        const std::uint8_t mark = at(i + 1);
        i += 2;
        if (mark == jpeg_end) return true;
        if (stands_alone(mark)) continue;
        if (i + 1 >= bytes.size()) return false;
        i += std::size_t{at(i)} << 8 | at(i + 1);
    }
    return false;
}

}  // namespace voxtone::io

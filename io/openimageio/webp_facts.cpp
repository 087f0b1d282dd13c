// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/openimageio/webp_facts.h"

#include <string_view>

namespace voxtone::io {

WebpFacts webp_facts(std::span<const std::byte> file) {
    using namespace std::string_view_literals;
    constexpr std::size_t head_bytes = 12, chunk_head_bytes = 8;
    constexpr std::string_view jpeg_mark = "Exif\0\0"sv;  // which some programs leave before the block
    const std::span bytes(reinterpret_cast<const std::uint8_t*>(file.data()), file.size());
    const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    WebpFacts facts;
    for (std::size_t at = head_bytes; at < bytes.size() && bytes.size() - at >= chunk_head_bytes;) {
        const std::string_view kind = text.substr(at, 4);
        std::size_t length = 0;
        for (std::size_t i = 0; i < 4; ++i) length |= std::size_t{bytes[at + 4 + i]} << (8 * i);
        at += chunk_head_bytes;
        if (length > bytes.size() - at) break;
        if (kind == "ICCP") facts.icc_profile = bytes.subspan(at, length);
        if (kind == "EXIF") {
            const std::size_t skipped = text.substr(at, length).starts_with(jpeg_mark) ? jpeg_mark.size() : 0;
            facts.exif = exif_facts(bytes.subspan(at + skipped, length - skipped));
        }
        at += length + length % 2;
    }
    return facts;
}

}  // namespace voxtone::io

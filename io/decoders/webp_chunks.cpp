// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/decoders/webp_chunks.h"

#include <string_view>

namespace voxtone::io {

namespace {

using namespace std::string_view_literals;
using Bytes = std::span<const std::uint8_t>;

std::uint32_t little_endian(Bytes bytes, std::size_t at, std::size_t count) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < count; ++i) value |= std::uint32_t{bytes[at + i]} << (8 * i);
    return value;
}

void read_head(Bytes chunk, WebpFacts& facts) {
    constexpr std::uint8_t animation = 0x02;
    if (chunk.size() < 10) return;
    facts.is_animation = (chunk[0] & animation) != 0;
    facts.canvas_width_px = little_endian(chunk, 4, 3) + 1;
    facts.canvas_height_px = little_endian(chunk, 7, 3) + 1;
}

void read_frame(Bytes chunk, WebpFacts& facts) {
    constexpr std::size_t head_bytes = 16;
    if (chunk.size() < head_bytes || ++facts.frames > 1) return;
    facts.first = {2 * little_endian(chunk, 0, 3), 2 * little_endian(chunk, 3, 3), little_endian(chunk, 6, 3) + 1,
                   little_endian(chunk, 9, 3) + 1, chunk.subspan(head_bytes)};
}

void read_exif(Bytes chunk, WebpFacts& facts) {
    constexpr std::string_view jpeg_mark = "Exif\0\0"sv;  // which some programs leave before the block
    const std::string_view text(reinterpret_cast<const char*>(chunk.data()), chunk.size());
    facts.exif = exif_facts(chunk.subspan(text.starts_with(jpeg_mark) ? jpeg_mark.size() : 0));
}

}  // namespace

WebpFacts webp_facts(std::span<const std::byte> file) {
    constexpr std::size_t head_bytes = 12, chunk_head_bytes = 8;
    const Bytes bytes(reinterpret_cast<const std::uint8_t*>(file.data()), file.size());
    const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    WebpFacts facts;
    for (std::size_t at = head_bytes; at < bytes.size() && bytes.size() - at >= chunk_head_bytes;) {
        const std::string_view kind = text.substr(at, 4);
        const std::size_t length = little_endian(bytes, at + 4, 4);
        at += chunk_head_bytes;
        if (length > bytes.size() - at) break;
        const Bytes chunk = bytes.subspan(at, length);
        if (kind == "VP8X") read_head(chunk, facts);
        if (kind == "ANMF") read_frame(chunk, facts);
        if (kind == "ICCP") facts.icc_profile = chunk;
        if (kind == "EXIF") read_exif(chunk, facts);
        at += length + length % 2;
    }
    return facts;
}

}  // namespace voxtone::io

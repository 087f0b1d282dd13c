// SPDX-License-Identifier: GPL-3.0-or-later
//
// Based on: Y. Collet, "xxHash fast digest algorithm", specification 0.1.1, section "XXH64 algorithm description"; seed
// 0.
#include <bit>

#include "voxtone/io/files/sha256.h"

namespace voxtone::io {
namespace {

constexpr std::uint64_t prime1 = 0x9E3779B185EBCA87, prime2 = 0xC2B2AE3D27D4EB4F, prime3 = 0x165667B19E3779F9,
                        prime4 = 0x85EBCA77C2B2AE63, prime5 = 0x27D4EB2F165667C5;

std::uint64_t round(std::uint64_t lane, std::uint64_t input) { return std::rotl(lane + input * prime2, 31) * prime1; }

/// `word(i)` gives bytes 8 i .. 8 i + 7 as a little-endian number, `byte(i)` byte i.
template <class Word, class Byte>
std::uint64_t digest(std::uint64_t bytes, Word&& word, Byte&& byte) {
    std::uint64_t at = 0, h = prime5;
    if (bytes >= 32) {
        std::uint64_t a = prime1 + prime2, b = prime2, c = 0, d = 0 - prime1;
        for (; at + 32 <= bytes; at += 32) {
            a = round(a, word(at / 8));
            b = round(b, word(at / 8 + 1));
            c = round(c, word(at / 8 + 2));
            d = round(d, word(at / 8 + 3));
        }
        h = std::rotl(a, 1) + std::rotl(b, 7) + std::rotl(c, 12) + std::rotl(d, 18);
        for (const std::uint64_t lane : {a, b, c, d}) h = (h ^ round(0, lane)) * prime1 + prime4;
    }
    h += bytes;
    for (; at + 8 <= bytes; at += 8) h = std::rotl(h ^ round(0, word(at / 8)), 27) * prime1 + prime4;
    if (at + 4 <= bytes) {
        std::uint64_t four = 0;
        for (std::uint64_t i = 0; i < 4; ++i) four |= std::uint64_t{byte(at + i)} << (8 * i);
        h = std::rotl(h ^ (four * prime1), 23) * prime2 + prime3;
        at += 4;
    }
    for (; at < bytes; ++at) h = std::rotl(h ^ (byte(at) * prime5), 11) * prime1;
    h = (h ^ (h >> 33)) * prime2;
    h = (h ^ (h >> 29)) * prime3;
    return h ^ (h >> 32);
}

}  // namespace

std::uint64_t xxh64(std::span<const std::uint8_t> bytes) {
    return digest(
        bytes.size(),
        [&](std::uint64_t i) {
            std::uint64_t value = 0;
            for (std::uint64_t b = 0; b < 8; ++b) value |= std::uint64_t{bytes[8 * i + b]} << (8 * b);
            return value;
        },
        [&](std::uint64_t i) { return bytes[i]; });
}

std::uint64_t layer_digest(const LayerRuns& layer) {
    if (layer.rows() == 0) return xxh64({});
    // The rows lie behind one another.
    const Run* const first = layer.row(0).data();
    const auto last = layer.row(layer.rows() - 1);
    const auto runs = static_cast<std::uint64_t>(last.data() + last.size() - first);
    auto four = [&](std::uint64_t i) {
        return std::uint64_t{first[i].length} | std::uint64_t{first[i].material} << 16;
    };
    return digest(
        4 * runs, [&](std::uint64_t i) { return four(2 * i) | four(2 * i + 1) << 32; },
        [&](std::uint64_t i) { return static_cast<std::uint8_t>(four(i / 4) >> (8 * (i % 4))); });
}

}  // namespace voxtone::io

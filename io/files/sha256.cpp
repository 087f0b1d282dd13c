// SPDX-License-Identifier: GPL-3.0-or-later
//
// Based on: FIPS 180-4, "Secure Hash Standard", NIST 2015, sections 4.1.2, 4.2.2, 5.1.1 and 6.2.
#include "voxtone/io/files/sha256.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include <fmt/core.h>

namespace voxtone::io {
namespace {

// First 32 bits of the fractional parts of the cube roots of the first 64 primes (section 4.2.2).
constexpr std::array<std::uint32_t, 64> k = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

}  // namespace

void Sha256::block(const std::uint8_t* at) {
    std::array<std::uint32_t, 64> w;
    for (std::size_t t = 0; t < 16; ++t, at += 4)
        w[t] = std::uint32_t{at[0]} << 24 | std::uint32_t{at[1]} << 16 | std::uint32_t{at[2]} << 8 | at[3];
    for (std::size_t t = 16; t < 64; ++t) {
        const std::uint32_t a = w[t - 15], b = w[t - 2];
        w[t] = w[t - 16] + w[t - 7] + (std::rotr(a, 7) ^ std::rotr(a, 18) ^ (a >> 3)) +
               (std::rotr(b, 17) ^ std::rotr(b, 19) ^ (b >> 10));
    }
    auto [a, b, c, d, e, f, g, h] = state_;
    for (std::size_t t = 0; t < 64; ++t) {
        const std::uint32_t t1 =
            h + (std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25)) + ((e & f) ^ (~e & g)) + k[t] + w[t];
        const std::uint32_t t2 =
            (std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22)) + ((a & b) ^ (a & c) ^ (b & c));
        h = g, g = f, f = e, e = d + t1, d = c, c = b, b = a, a = t1 + t2;
    }
    const std::array<std::uint32_t, 8> add = {a, b, c, d, e, f, g, h};
    for (std::size_t i = 0; i < 8; ++i) state_[i] += add[i];
}

void Sha256::update(std::span<const std::uint8_t> bytes) {
    while (!bytes.empty()) {
        const std::size_t filled = bytes_ % 64, n = std::min<std::size_t>(64 - filled, bytes.size());
        std::memcpy(held_.data() + filled, bytes.data(), n);
        bytes_ += n;
        bytes = bytes.subspan(n);
        if (bytes_ % 64 == 0) block(held_.data());
    }
}

std::string Sha256::finish() {
    const std::uint64_t bits = bytes_ * 8;
    std::array<std::uint8_t, 72> end{0x80};
    const std::size_t zeros = (119 - bytes_ % 64) % 64;  // so that 8 bytes of length end a block
    for (std::size_t i = 0; i < 8; ++i) end[1 + zeros + i] = static_cast<std::uint8_t>(bits >> (56 - 8 * i));
    update(std::span(end).first(1 + zeros + 8));
    std::string hex;
    for (const auto word : state_) hex += fmt::format("{:08x}", word);
    return hex;
}

std::string sha256(std::span<const std::uint8_t> bytes) {
    Sha256 digest;
    digest.update(bytes);
    return digest.finish();
}

std::string content_sha256(std::uint32_t width_px, std::uint32_t height_px,
                           std::span<const std::uint64_t> layer_digests) {
    Sha256 digest;
    auto put = [&](std::uint64_t value, std::size_t bytes) {
        std::array<std::uint8_t, 8> little;
        for (std::size_t i = 0; i < 8; ++i) little[i] = static_cast<std::uint8_t>(value >> (8 * i));
        digest.update(std::span(little).first(bytes));
    };
    put(width_px, 4);
    put(height_px, 4);
    put(layer_digests.size(), 4);
    for (const auto d : layer_digests) put(d, 8);
    return digest.finish();
}

}  // namespace voxtone::io

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Digests: SHA-256 (FIPS 180-4) for what is written into files, XXH64 (xxHash specification 0.1.1, 64 bits, seed 0) for
// the runs of a layer, where SHA-256 would cost more than the encoder.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "voxtone/io/layers/layer_runs.h"

namespace voxtone::io {

class Sha256 {
public:
    void update(std::span<const std::uint8_t> bytes);
    /// The digest of all that was given; 64 lower-case hexadecimal digits.
    [[nodiscard]] std::string finish();

private:
    void block(const std::uint8_t* at);

    std::array<std::uint32_t, 8> state_ = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                           0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
    std::array<std::uint8_t, 64> held_{};
    std::uint64_t bytes_ = 0;
};

[[nodiscard]] std::string sha256(std::span<const std::uint8_t> bytes);

[[nodiscard]] std::uint64_t xxh64(std::span<const std::uint8_t> bytes);

/// XXH64 of a layer's runs in bitmap order, each as two little-endian 16-bit numbers: length, material.
[[nodiscard]] std::uint64_t layer_digest(const LayerRuns& layer);

/// What a stack holds, whoever encoded it: SHA-256 over width, height, number of layers (little-endian 32 bits each)
/// and the layers' digests (little-endian 64 bits each) in layer order. The manifest's `content_sha256`.
[[nodiscard]] std::string content_sha256(std::uint32_t width_px, std::uint32_t height_px,
                                         std::span<const std::uint64_t> layer_digests);

}  // namespace voxtone::io

// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a stack holds, whoever encoded it, as the manifest's `content_sha256` says it: SHA-256 over the layers' XXH64,
// because SHA-256 of every run would cost more than the encoder.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "io/layers/layer_runs.h"

namespace voxtone::io {

/// XXH64 of a layer's runs in bitmap order, each as two little-endian 16-bit numbers: length, material.
[[nodiscard]] std::uint64_t layer_digest(const LayerRuns& layer);

/// SHA-256 over width, height, number of layers (little-endian 32 bits each) and the layers' digests (little-endian 64
/// bits each) in layer order.
[[nodiscard]] std::string content_sha256(std::uint32_t width_px, std::uint32_t height_px,
                                         std::span<const std::uint64_t> layer_digests);

}  // namespace voxtone::io

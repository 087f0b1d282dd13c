// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/layer_digest.h"

#include <array>
#include <bit>
#include <cstddef>

#include "io/files/sha256.h"
#include "io/files/xxh64.h"

namespace voxtone::io {

// So that the runs in memory are the bytes that the digest is defined over.
static_assert(std::endian::native == std::endian::little);
static_assert(sizeof(Run) == 4 && offsetof(Run, length) == 0 && offsetof(Run, material) == 2);

std::uint64_t layer_digest(const LayerRuns& layer) {
    if (layer.rows() == 0) return xxh64({});
    // The rows lie behind one another.
    const Run* const first = layer.row(0).data();
    const std::span<const Run> last = layer.row(layer.rows() - 1);
    const auto bytes = static_cast<std::size_t>(last.data() + last.size() - first) * sizeof(Run);
    return xxh64({reinterpret_cast<const std::uint8_t*>(first), bytes});
}

std::string content_sha256(std::uint32_t width_px, std::uint32_t height_px,
                           std::span<const std::uint64_t> layer_digests) {
    Sha256 digest;
    const auto put = [&](std::uint64_t value, std::size_t bytes) {
        std::array<std::uint8_t, 8> little;
        for (std::size_t i = 0; i < 8; ++i) little[i] = static_cast<std::uint8_t>(value >> (8 * i));
        digest.update(std::span(little).first(bytes));
    };
    put(width_px, 4);
    put(height_px, 4);
    put(layer_digests.size(), 4);
    for (const std::uint64_t layer : layer_digests) put(layer, 8);
    return digest.finish();
}

}  // namespace voxtone::io

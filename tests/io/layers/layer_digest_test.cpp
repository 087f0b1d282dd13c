// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/layer_digest.h"

#include <cstdint>
#include <vector>

#include <catch2/catch.hpp>

#include "io/files/xxh64.h"

using namespace voxtone::io;

TEST_CASE("a layer's digest is that of its runs", "[digest]") {
    for (std::uint32_t runs = 1; runs < 40; ++runs) {
        LayerRuns layer(3 * runs, 1);
        std::vector<std::uint8_t> bytes;
        for (std::uint32_t i = 0; i < runs; ++i) {
            layer.push(3, static_cast<Material>(i % 5));
            for (const std::uint8_t b : {3u, 0u, i % 5, 0u}) bytes.push_back(b);
        }
        layer.end_row();
        REQUIRE(layer_digest(layer) == xxh64(bytes));
    }
}

TEST_CASE("the digest of a stack is that of its definition, byte for byte", "[digest]") {
    // Python: hashlib.sha256(struct.pack("<3I2Q", 6, 4, 2, 1, 0x8000000000000002)).hexdigest()
    CHECK(content_sha256(6, 4, std::vector<std::uint64_t>{1, 0x8000000000000002}) ==
          "ab2f7a45ba8c4712fa7af9d86c0e723d273b36df27b5d50bfd5e6be48235574f");
    // XXH64 of 03 00 01 00 03 00 00 00 02 00 02 00 04 00 01 00, worked out by the specification
    LayerRuns layer(6, 2);
    layer.push(3, 1);
    layer.push(3, 0);
    layer.end_row();
    layer.push(2, 2);
    layer.push(4, 1);
    layer.end_row();
    CHECK(layer_digest(layer) == 0xF75B4AE766650B30);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "io/files/sha256.h"
#include "io/files/xxh64.h"

using namespace voxtone::io;

TEST_CASE("digests are those of the standards", "[digest]") {
    auto bytes = [](const std::string& text) { return std::vector<std::uint8_t>(text.begin(), text.end()); };
    // FIPS 180-4 examples (NIST cryptographic toolkit).
    CHECK(sha256(bytes("")) == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    CHECK(sha256(bytes("abc")) == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    CHECK(sha256(bytes("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq")) ==
          "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    CHECK(sha256(std::vector<std::uint8_t>(1000000, 'a')) ==
          "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
    // In pieces of any size it is the same.
    const auto text = bytes(std::string(300, 'x') + "end");
    for (std::size_t piece = 1; piece < 130; ++piece) {
        Sha256 digest;
        for (std::size_t at = 0; at < text.size(); at += piece)
            digest.update(std::span(text).subspan(at, std::min(piece, text.size() - at)));
        REQUIRE(digest.finish() == sha256(text));
    }
    // Published with the algorithm: the empty input and "abc", seed 0.
    CHECK(xxh64(bytes("")) == 0xEF46DB3751D8E999u);
    CHECK(xxh64(bytes("abc")) == 0x44BC2CF5AD770999u);
    for (std::size_t piece = 1; piece < 130; ++piece) {
        Xxh64 digest;
        for (std::size_t at = 0; at < text.size(); at += piece)
            digest.update(text.data() + at, std::min(piece, text.size() - at));
        REQUIRE(digest.digest() == xxh64(text));
    }
}

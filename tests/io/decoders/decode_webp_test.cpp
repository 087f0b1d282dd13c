// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/decoders/decode_webp.h"

#include <cstdint>
#include <functional>
#include <string>

#include <webp/encode.h>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/decoders/decode_image.h"
#include "io/decoders/webp_chunks.h"
#include "io/pictures/webp.h"
#include "optics/colour/colour.h"
#include "tests/io/decoders/picture_bytes.h"

using namespace voxtone;
using namespace voxtone::io;
using namespace voxtone::test;
using Catch::Contains;
using Eigen::Vector3d;

namespace {

/// The least first.
std::string little_endian(std::size_t value, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i) & 255);
    return text;
}

std::string chunk(const std::string& kind, std::string data) {
    std::string made = kind + little_endian(data.size(), 4);
    if (data.size() % 2) data += '\0';
    return made + data;
}

std::string extended_head(int flags, std::size_t width, std::size_t height) {
    return chunk("VP8X", little_endian(static_cast<std::size_t>(flags), 4) + little_endian(width - 1, 3) +
                             little_endian(height - 1, 3));
}

std::string riff(const std::string& chunks) { return chunk("RIFF", "WEBP" + chunks); }

/// 2 x 1 pixels of one colour.
std::string webp_with(const std::string& profile, const std::string& exif) {
    const auto plain = webp_bytes({2, 1, 3, {200, 40, 40, 200, 40, 40}});
    return riff(extended_head(0x28, 2, 1) + chunk("ICCP", profile) + std::string(plain.begin() + 12, plain.end()) +
                chunk("EXIF", exif));
}

using Codes = std::vector<std::uint8_t>;

/// Lossless, codes of RGBA.
std::string lossless(const Codes& rgba, int width, int height) {
    std::uint8_t* out = nullptr;
    const std::size_t size = WebPEncodeLosslessRGBA(rgba.data(), width, height, 4 * width, &out);
    std::string file(reinterpret_cast<const char*>(out), size);
    WebPFree(out);
    return file;
}

/// Without the head of the file and, where it is extended, of that.
std::string pixels_of(const std::string& file) { return file.substr(file.compare(12, 4, "VP8X") == 0 ? 30 : 12); }

std::string frame(std::size_t x, std::size_t y, std::size_t width, std::size_t height, const std::string& pixels) {
    return chunk("ANMF", little_endian(x / 2, 3) + little_endian(y / 2, 3) + little_endian(width - 1, 3) +
                             little_endian(height - 1, 3) + little_endian(100, 3) + std::string(1, '\0') + pixels);
}

DecodedImage read(const std::string& file, const DecodeOptions& options = {}) {
    return decode_image(std::as_bytes(std::span(file)), "a.webp", options);
}

std::string refusal_of(const std::string& file, const DecodeOptions& options = {}) {
    try {
        (void)read(file, options);
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

}  // namespace

TEST_CASE("Lossless WebP gives its codes, colours below nothing as well", "[webp]") {
    const Codes rgba{255, 0, 0, 255, 0, 200, 17, 255, 3, 4, 250, 128, 99, 98, 97, 255, 1, 2, 3, 255, 10, 20, 30, 0};
    const DecodedImage image = read(lossless(rgba, 3, 2));
    REQUIRE(image.texels.width_px == 3);
    REQUIRE(image.texels.height_px == 2);
    CHECK(image.has_alpha);
    for (std::size_t i = 0; i < 20; ++i) CHECK(image.texels.srgb8[i] == rgba[i]);
    CHECK(image.texels.srgb8[23] == 0);
    CHECK_FALSE(read(lossless(Codes(16, 255), 2, 2)).has_alpha);
}

TEST_CASE("Lossy WebP gives its colours, and coverage as it was", "[webp]") {
    Codes rgba;
    for (int i = 0; i < 64; ++i) rgba.insert(rgba.end(), {200, 40, 40, static_cast<std::uint8_t>(4 * i)});
    const auto file = webp_bytes({8, 8, 4, rgba});
    const DecodedImage image = read({file.begin(), file.end()});
    for (std::size_t i = 16; i < 64; ++i) {
        CHECK(image.texels.srgb8[4 * i] == Approx(200).margin(6));
        CHECK(image.texels.srgb8[4 * i + 3] == 4 * i);
    }
}

TEST_CASE("WebP says its profile and how it is turned", "[webp]") {
    // to be turned by a quarter
    const std::string turned("MM\0*\0\0\0\x08\0\1\1\x12\0\3\0\0\0\1\0\6\0\0\0\0\0\0", 26);
    const std::vector<std::uint8_t> profile = swapped_profile();
    for (const std::string& exif : {turned, std::string("Exif\0\0", 6) + turned}) {
        const std::string file = webp_with({profile.begin(), profile.end()}, exif);
        const DecodedImage image = read(file, {.turn_upright = true});
        CHECK(image.texels.height_px == 2);
        CHECK((Vector3d(image.texels.rgb(0).cast<double>()) - Vector3d(0.02, 0.02, 0.578)).norm() < 0.03);
        CHECK(image.warnings.empty());
        // Cut chunks say nothing, and are not read behind.
        for (std::size_t length = 0; length < file.size(); ++length) {
            const WebpFacts facts = webp_facts(std::as_bytes(std::span(file)).first(length));
            CHECK((facts.icc_profile.empty() || facts.icc_profile.size() == profile.size()));
            CHECK(facts.exif.orientation == 1);
        }
    }
    CHECK(read(webp_with("", "")).texels.width_px == 2);
}

TEST_CASE("Of an animated WebP the first frame is taken, laid on its canvas", "[webp]") {
    const Codes red{200, 0, 0, 255, 200, 0, 0, 255}, blue{0, 0, 200, 255, 0, 0, 200, 128};
    const auto half = webp_bytes({2, 1, 4, {200, 40, 40, 128, 200, 40, 40, 128}});
    const std::string head = extended_head(0x12, 5, 4), loop = chunk("ANIM", std::string(6, '\0')),
                      second = frame(0, 0, 2, 1, pixels_of(lossless(blue, 2, 1)));
    SECTION("lossless") {
        const DecodedImage image = read(riff(head + loop + frame(2, 2, 2, 1, pixels_of(lossless(red, 2, 1))) + second));
        REQUIRE(image.texels.width_px == 5);
        REQUIRE(image.texels.height_px == 4);
        for (std::size_t i = 0; i < 20; ++i) {
            const bool covered = i == 12 || i == 13;
            CHECK(image.texels.srgb8[4 * i] == (covered ? 200 : 0));
            CHECK(image.texels.srgb8[4 * i + 3] == (covered ? 255 : 0));
        }
        REQUIRE(image.warnings.size() == 1);
        CHECK_THAT(image.warnings[0], Contains("a.webp") && Contains("first frame") && Contains("[several-pictures]"));
    }
    SECTION("lossy, with coverage beside its colours") {
        const DecodedImage image =
            read(riff(head + loop + frame(0, 0, 2, 1, pixels_of({half.begin(), half.end()})) + second));
        CHECK(image.texels.srgb8[3] == 128);
        CHECK(image.texels.srgb8[0] == Approx(200).margin(6));
    }
    SECTION("frames that do not lie on it, or are not there") {
        const std::string pixels = pixels_of(lossless(red, 2, 1));
        for (const std::string& frames :
             {frame(4, 0, 2, 1, pixels), frame(0, 4, 2, 1, pixels), frame(0, 0, 3, 1, pixels), frame(0, 0, 2, 1, ""),
              frame(0, 0, 16000000, 1, pixels), std::string()})
            CHECK_THAT(refusal_of(riff(head + loop + frames)), Contains("a.webp") && Contains("damaged"));
    }
}

TEST_CASE("WebP that is cut at any byte, or too large, is refused in a sentence", "[webp]") {
    Codes rgba;
    for (int i = 0; i < 400; ++i)
        rgba.insert(rgba.end(), {static_cast<std::uint8_t>(i * i), static_cast<std::uint8_t>(7 * i), 40, 200});
    const auto lossy = webp_bytes({20, 20, 4, rgba});
    for (const std::string& file : {lossless(rgba, 20, 20), std::string(lossy.begin(), lossy.end())}) {
        REQUIRE(refusal_of(file) == "no error");
        for (std::size_t length = 12; length + 1 < file.size(); ++length) {
            INFO(length);
            CHECK_THAT(refusal_of(file.substr(0, length)), Contains("a.webp") && Contains("cut short"));
        }
        CHECK_THAT(refusal_of(file, {.max_pixels = 399}), Contains("20 x 20 pixels, more than the 399 allowed"));
    }
    CHECK_THAT(refusal_of(riff(extended_head(0x02, 16000000, 16000000))), Contains("16000000 x 16000000"));
}

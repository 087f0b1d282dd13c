// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/picture_writer.h"

#include <png.h>

#include <algorithm>
#include <string>

#include <catch2/catch.hpp>

#include "io/pictures/srgb_code.h"

using namespace voxtone::io;

namespace {

/// Decoded by libpng's simplified reader, which has its own idea of every chunk.
Picture8 decoded(const std::vector<std::uint8_t>& bytes, std::uint32_t channels) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    REQUIRE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()));
    image.format = channels == 3 ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
    Picture8 picture{image.width, image.height, channels, {}};
    picture.codes.resize(PNG_IMAGE_SIZE(image));
    REQUIRE(png_image_finish_read(&image, nullptr, picture.codes.data(), 0, nullptr));
    return picture;
}

LinearPicture two_by_three() {
    return {2, 3, {{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 0.5f}, {0.2f, 0.4f, 0.6f, 1}, {0, 0, 0, 0}, {2, -1, 0.5f, 1}}};
}

}  // namespace

TEST_CASE("A picture comes back from its PNG") {
    for (const bool transparent : {false, true}) {
        const Picture8 picture =
            transparent ? encode_transparent(two_by_three()) : encode_over(two_by_three(), {1, 1, 1});
        const Picture8 back = decoded(png_bytes(picture), picture.channels);
        CHECK(back.width_px == 2);
        CHECK(back.height_px == 3);
        CHECK(back.codes == picture.codes);
    }
}

TEST_CASE("Backgrounds are composed in linear light") {
    const Picture8 over_white = encode_over(two_by_three(), {1, 1, 1});
    const std::uint8_t half = linear_to_srgb8(0.5f);
    CHECK(half == 188);  // 1.055 * 0.5^(1/2.4) - 0.055 = 0.7354
    CHECK(std::vector<std::uint8_t>(over_white.codes.begin() + 6, over_white.codes.begin() + 9) ==
          std::vector<std::uint8_t>{half, half, 255});
    CHECK(std::vector<std::uint8_t>(over_white.codes.begin() + 12, over_white.codes.begin() + 18) ==
          std::vector<std::uint8_t>{255, 255, 255, 255, 0, half});  // nothing there; clamped
    const Picture8 clear = encode_transparent(two_by_three());
    CHECK(std::vector<std::uint8_t>(clear.codes.begin() + 8, clear.codes.begin() + 12) ==
          std::vector<std::uint8_t>{0, 0, 255, 128});
    CHECK(std::vector<std::uint8_t>(clear.codes.begin() + 16, clear.codes.begin() + 20) ==
          std::vector<std::uint8_t>{0, 0, 0, 0});
}

TEST_CASE("The density of the pixels is in the file when it is known") {
    const Picture8 picture = encode_over(two_by_three(), {1, 1, 1});
    const auto find = [](const std::vector<std::uint8_t>& bytes, const std::string& chunk) {
        return std::search(bytes.begin(), bytes.end(), chunk.begin(), chunk.end());
    };
    const std::vector<std::uint8_t> with = png_bytes(picture, {600 / 25.4, 300 / 25.4});
    const auto chunk = find(with, "pHYs");
    REQUIRE(chunk + 13 < with.end());
    const auto word = [&](int at) {
        return chunk[at] << 24 | chunk[at + 1] << 16 | chunk[at + 2] << 8 | chunk[at + 3];
    };
    CHECK(word(4) == 23622);
    CHECK(word(8) == 11811);
    CHECK(chunk[12] == 1);  // metres
    const std::vector<std::uint8_t> without = png_bytes(picture);
    CHECK(find(without, "pHYs") == without.end());
    CHECK(find(without, "sRGB") != without.end());
}

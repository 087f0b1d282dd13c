// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/exr_writer.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cstring>

#include <catch2/catch.hpp>

using namespace voxtone::io;

TEST_CASE("EXR keeps every bit of the light, the coverage and the size of a pixel") {
    LinearPicture picture{3, 2, {}};
    for (int i = 0; i < 6; ++i) picture.pixels.emplace_back(0.1f * float(i), 1e-6f, 7.5f, i == 2 ? 0.5f : 1.0f);
    const std::vector<std::uint8_t> bytes = exr_bytes(picture, {600 / 25.4, 300 / 25.4});
    CHECK(exr_bytes(picture, {600 / 25.4, 300 / 25.4}) == bytes);

    OIIO::Filesystem::IOMemReader memory(const_cast<std::uint8_t*>(bytes.data()), bytes.size());
    const auto input = OIIO::ImageInput::open("picture.exr", nullptr, &memory);
    REQUIRE(input);
    const OIIO::ImageSpec& spec = input->spec();
    CHECK(spec.width == 3);
    CHECK(spec.height == 2);
    CHECK(spec.format == OIIO::TypeDesc::FLOAT);
    CHECK(spec.channelnames == std::vector<std::string>{"R", "G", "B", "A"});
    CHECK(spec.get_float_attribute("PixelAspectRatio") == Approx(0.5));
    CHECK(spec.get_float_attribute("XResolution") == Approx(600));
    std::vector<Eigen::Vector4f> read(6);
    REQUIRE(input->read_image(0, 0, 0, 4, OIIO::TypeDesc::FLOAT, read.data()));
    for (int i = 0; i < 6; ++i) {
        const Eigen::Vector4f& p = picture.pixels[std::size_t(i)];
        CHECK(read[std::size_t(i)] == Eigen::Vector4f(p[0] * p[3], p[1] * p[3], p[2] * p[3], p[3]));
    }
}

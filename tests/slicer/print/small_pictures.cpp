// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/slicer/print/small_pictures.h"

#include <algorithm>
#include <cmath>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <png.h>
#include <catch2/catch.hpp>

namespace voxtone::test {

Numbers read_numbers(const std::string& file) {
    Imf::InputFile in(file.c_str(), 1);
    const auto box = in.header().dataWindow();
    Numbers numbers{box.max.x + 1, box.max.y + 1, {}, Imf::hasComments(in.header()) ? Imf::comments(in.header()) : ""};
    Imf::FrameBuffer frame;
    const std::size_t row = sizeof(float) * std::size_t(numbers.width);
    for (auto c = in.header().channels().begin(); c != in.header().channels().end(); ++c) {
        auto& values = numbers.of[c.name()];
        values.resize(std::size_t(numbers.width) * std::size_t(numbers.height));
        frame.insert(c.name(), Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), sizeof(float), row));
    }
    in.setFrameBuffer(frame);
    in.readPixels(0, numbers.height - 1);
    return numbers;
}

std::vector<std::uint8_t> read_codes(const std::string& file) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    REQUIRE(png_image_begin_read_from_file(&image, file.c_str()));
    image.format = PNG_FORMAT_RGB;
    std::vector<std::uint8_t> codes(PNG_IMAGE_SIZE(image));
    REQUIRE(png_image_finish_read(&image, nullptr, codes.data(), 0, nullptr));
    return codes;
}

double code_of(double light) {
    const double x = std::clamp(light, 0.0, 1.0);
    return 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055);
}

}  // namespace voxtone::test

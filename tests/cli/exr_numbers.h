// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <OpenImageIO/imageio.h>
#include <catch2/catch.hpp>

namespace voxtone::test {

/// An EXR file's floats, rows from the top, channels interleaved with R, G, B first.
struct ExrNumbers {
    int width = 0, height = 0, channels = 0;
    std::vector<float> values;
    [[nodiscard]] const float* at(int x, int y) const {
        return values.data() + (std::size_t(y) * std::size_t(width) + std::size_t(x)) * std::size_t(channels);
    }
};

inline ExrNumbers read_exr(const std::string& path) {
    const auto in = OIIO::ImageInput::open(path);
    REQUIRE(in);
    const OIIO::ImageSpec& spec = in->spec();
    ExrNumbers n{spec.width, spec.height, spec.nchannels, {}};
    n.values.resize(std::size_t(n.width) * std::size_t(n.height) * std::size_t(n.channels));
    REQUIRE(in->read_image(0, 0, 0, n.channels, OIIO::TypeDesc::FLOAT, n.values.data()));
    return n;
}

}  // namespace voxtone::test

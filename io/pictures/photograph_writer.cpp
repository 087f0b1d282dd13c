// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/photograph_writer.h"

#include <filesystem>

#include <fmt/format.h>

#include "base/error.h"
#include "io/pictures/srgb_code.h"
#include "io/programs/module_function.h"

namespace voxtone::io {

std::vector<std::uint8_t> photograph_bytes(const Photograph& photograph, const std::string& file_name) {
    const std::string extension = std::filesystem::path(file_name).extension().string();
    const bool png = extension == ".png", tiff = extension == ".tif" || extension == ".tiff", exr = extension == ".exr";
    if (!png && !tiff && !exr)
        throw UsageError(fmt::format("{}: photographs are written as .png, .tif or .exr", file_name));
    const bool codes = photograph.bits == 8;
    if (codes && !png) throw UsageError(fmt::format("{}: 8-bit photographs are written as .png", file_name));
    Photograph coded;
    if (codes) {
        coded = photograph;
        for (Eigen::Vector3f& pixel : coded.pixels)
            for (float& value : pixel) value = float(linear_to_srgb8(value)) / 255.0f;
    }
    using Encode = void(const Photograph&, const std::string&, std::vector<std::uint8_t>&);
    std::vector<std::uint8_t> bytes;
    reinterpret_cast<Encode*>(module_function("voxtone-photographs.so", "voxtone_encode_photograph"))(
        codes ? coded : photograph, tiff ? ".tif" : extension, bytes);
    return bytes;
}

}  // namespace voxtone::io

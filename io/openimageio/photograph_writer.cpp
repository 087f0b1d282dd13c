// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/openimageio/photograph_writer.h"

#include <filesystem>
#include <stdexcept>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "base/error.h"
#include "io/openimageio/no_threads.h"
#include "io/pictures/srgb_code.h"

namespace voxtone::io {

std::vector<std::uint8_t> photograph_bytes(const Photograph& photograph, const std::string& file_name) {
    const std::string extension = std::filesystem::path(file_name).extension().string();
    const bool png = extension == ".png", tiff = extension == ".tif" || extension == ".tiff", exr = extension == ".exr";
    if (!png && !tiff && !exr)
        throw UsageError(fmt::format("{}: photographs are written as .png, .tif or .exr", file_name));
    const bool codes = photograph.bits == 8;
    if (codes && !png) throw UsageError(fmt::format("{}: 8-bit photographs are written as .png", file_name));
    OIIO::ImageSpec spec(int(photograph.width_px), int(photograph.height_px), 3,
                         exr     ? OIIO::TypeDesc::FLOAT
                         : codes ? OIIO::TypeDesc::UINT8
                                 : OIIO::TypeDesc::UINT16);
    spec.attribute("oiio:ColorSpace", codes ? "sRGB" : "Linear");
    spec.attribute("compression", png ? "" : "zip");
    use_no_threads();
    if (exr)
        spec.attribute("DateTime",
                       "2000:01:01 00:00:00");  // else the time of day: no two runs would write the same bits
    if (exr && photograph.exposure_s > 0) spec.attribute("ExposureTime", float(photograph.exposure_s));
    std::vector<Eigen::Vector3f> coded;
    if (codes) {
        coded = photograph.pixels;
        for (Eigen::Vector3f& pixel : coded)
            for (float& value : pixel) value = float(linear_to_srgb8(value)) / 255.0f;
    }
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    const std::string kind = tiff ? "photograph.tif" : "photograph" + extension;
    const auto output = OIIO::ImageOutput::create(kind, &memory);
    if (!output || !output->open(kind, spec) ||
        !output->write_image(OIIO::TypeDesc::FLOAT, (codes ? coded : photograph.pixels).data()) || !output->close())
        throw std::logic_error("photograph: " + (output ? output->geterror() : OIIO::geterror()));
    return bytes;
}

}  // namespace voxtone::io

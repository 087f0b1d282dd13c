// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/exr_writer.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <stdexcept>

#include "voxtone/base/contracts.h"
#include "voxtone/base/units.h"

namespace voxtone::io {

std::vector<std::uint8_t> exr_bytes(const LinearPicture& picture, std::array<double, 2> px_per_mm) {
    VOXTONE_EXPECT(picture.width_px >= 1 && picture.height_px >= 1);
    VOXTONE_EXPECT(picture.pixels.size() == std::size_t{picture.width_px} * picture.height_px);
    std::vector<Eigen::Vector4f> premultiplied = picture.pixels;
    for (Eigen::Vector4f& pixel : premultiplied) pixel.head<3>() *= pixel[3];

    OIIO::ImageSpec spec(static_cast<int>(picture.width_px), static_cast<int>(picture.height_px), 4,
                         OIIO::TypeDesc::FLOAT);
    spec.attribute("compression", "zip");
    spec.attribute("oiio:ColorSpace", "Linear");
    static constexpr float srgb_primaries_and_d65[8] = {0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f};
    spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), srgb_primaries_and_d65);
    if (px_per_mm[0] > 0 && px_per_mm[1] > 0) {
        spec.attribute("XResolution", static_cast<float>(px_per_mm[0] * mm_per_inch));
        spec.attribute("YResolution", static_cast<float>(px_per_mm[1] * mm_per_inch));
        spec.attribute("ResolutionUnit", "in");
        spec.attribute("PixelAspectRatio", static_cast<float>(px_per_mm[1] / px_per_mm[0]));
    }
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    const auto output = OIIO::ImageOutput::create("picture.exr", &memory);
    if (!output || !output->open("picture.exr", spec) ||
        !output->write_image(OIIO::TypeDesc::FLOAT, premultiplied.data()) || !output->close())
        throw std::logic_error("OpenEXR: " + (output ? output->geterror() : OIIO::geterror()));
    return bytes;
}

}  // namespace voxtone::io

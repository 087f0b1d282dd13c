// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/pictures/exr_writer.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <stdexcept>

#include "voxtone/base/contracts.h"
#include "voxtone/base/units.h"

namespace voxtone::io {

std::vector<std::uint8_t> exr_bytes(const LinearPicture& picture, std::array<double, 2> px_per_mm) {
    NumberPicture numbers{picture.width_px, picture.height_px, {"R", "G", "B", "A"}, {}};
    numbers.values.reserve(4 * picture.pixels.size());
    for (const Eigen::Vector4f& pixel : picture.pixels)
        for (const float value : {pixel[3] * pixel[0], pixel[3] * pixel[1], pixel[3] * pixel[2], pixel[3]})
            numbers.values.push_back(value);
    return exr_bytes(numbers, px_per_mm);
}

std::vector<std::uint8_t> exr_bytes(const NumberPicture& picture, std::array<double, 2> px_per_mm) {
    VOXTONE_EXPECT(picture.width_px >= 1 && picture.height_px >= 1 && !picture.names.empty());
    VOXTONE_EXPECT(picture.values.size() == std::size_t{picture.width_px} * picture.height_px * picture.names.size());

    OIIO::ImageSpec spec(static_cast<int>(picture.width_px), static_cast<int>(picture.height_px),
                         static_cast<int>(picture.names.size()), OIIO::TypeDesc::FLOAT);
    spec.channelnames.assign(picture.names.begin(), picture.names.end());
    const auto alpha = std::find(picture.names.begin(), picture.names.end(), "A");
    spec.alpha_channel = alpha == picture.names.end() ? -1 : static_cast<int>(alpha - picture.names.begin());
    spec.attribute("compression", "zip");
    spec.attribute("oiio:ColorSpace", "Linear");
    // Without a date of ours the library writes that of the clock, and the same picture would have other bytes each
    // time.
    spec.attribute("DateTime", "0000:00:00 00:00:00");
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
        !output->write_image(OIIO::TypeDesc::FLOAT, picture.values.data()) || !output->close())
        throw std::logic_error("OpenEXR: " + (output ? output->geterror() : OIIO::geterror()));
    return bytes;
}

}  // namespace voxtone::io

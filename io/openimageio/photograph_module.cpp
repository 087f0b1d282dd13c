// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/openimageio/photograph_module.h"

#include <stdexcept>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "io/openimageio/no_threads.h"

void voxtone_encode_photograph(const voxtone::io::Photograph& photograph, const std::string& extension,
                               std::vector<std::uint8_t>& bytes) {
    const bool exr = extension == ".exr", codes = photograph.bits == 8;
    OIIO::ImageSpec spec(int(photograph.width_px), int(photograph.height_px), 3,
                         exr     ? OIIO::TypeDesc::FLOAT
                         : codes ? OIIO::TypeDesc::UINT8
                                 : OIIO::TypeDesc::UINT16);
    spec.attribute("oiio:ColorSpace", codes ? "sRGB" : "Linear");
    spec.attribute("compression", extension == ".png" ? "" : "zip");
    voxtone::io::use_no_threads();
    if (exr)
        spec.attribute("DateTime",
                       "2000:01:01 00:00:00");  // else the time of day: no two runs would write the same bits
    if (exr && photograph.exposure_s > 0) spec.attribute("ExposureTime", float(photograph.exposure_s));
    OIIO::Filesystem::IOVecOutput memory(bytes);
    const std::string kind = "photograph" + extension;
    const auto output = OIIO::ImageOutput::create(kind, &memory);
    if (!output || !output->open(kind, spec) || !output->write_image(OIIO::TypeDesc::FLOAT, photograph.pixels.data()) ||
        !output->close())
        throw std::logic_error("photograph: " + (output ? output->geterror() : OIIO::geterror()));
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/webp.h"

#include <webp/decode.h>
#include <webp/encode.h>

#include <memory>

#include "base/contracts.h"
#include "base/error.h"

namespace voxtone::io {

namespace {

constexpr float quality = 90;

struct Encoding {
    WebPPicture picture{};
    WebPMemoryWriter written{};

    Encoding() {
        VOXTONE_ENSURE(WebPPictureInit(&picture));
        WebPMemoryWriterInit(&written);
        picture.writer = WebPMemoryWrite;
        picture.custom_ptr = &written;
    }
    Encoding(const Encoding&) = delete;
    Encoding& operator=(const Encoding&) = delete;
    ~Encoding() {
        WebPPictureFree(&picture);
        WebPMemoryWriterClear(&written);
    }
};

WebPConfig config() {
    WebPConfig config;
    VOXTONE_ENSURE(WebPConfigPreset(&config, WEBP_PRESET_DEFAULT, quality));
    config.use_sharp_yuv = 1;  // strong colours side by side: their brightness is not blurred with their hue
    return config;
}

}  // namespace

std::vector<std::uint8_t> webp_bytes(const Picture8& picture) {
    VOXTONE_EXPECT(picture.channels == 3 || picture.channels == 4);
    VOXTONE_EXPECT(picture.width_px >= 1 && picture.width_px <= WEBP_MAX_DIMENSION);
    VOXTONE_EXPECT(picture.height_px >= 1 && picture.height_px <= WEBP_MAX_DIMENSION);
    const std::size_t row_bytes = std::size_t{picture.width_px} * picture.channels;
    VOXTONE_EXPECT(picture.codes.size() == row_bytes * picture.height_px);
    static const WebPConfig settings = config();
    Encoding encoding;
    encoding.picture.use_argb = 1;
    encoding.picture.width = int(picture.width_px);
    encoding.picture.height = int(picture.height_px);
    const auto import = picture.channels == 4 ? WebPPictureImportRGBA : WebPPictureImportRGB;
    // Sizes are right, so all that is left to go wrong is memory.
    if (!import(&encoding.picture, picture.codes.data(), int(row_bytes)) || !WebPEncode(&settings, &encoding.picture))
        throw ResourceError("a picture for a page does not fit into memory; close other programs");
    return {encoding.written.mem, encoding.written.mem + encoding.written.size};
}

bool is_webp(std::span<const std::uint8_t> file) {
    int width = 0, height = 0;
    return WebPGetInfo(file.data(), file.size(), &width, &height) != 0;
}

Picture8 read_webp(std::span<const std::uint8_t> file, const std::string& source) {
    int width = 0, height = 0;
    if (!WebPGetInfo(file.data(), file.size(), &width, &height)) throw InputError(source + " is no WebP picture");
    Picture8 picture{std::uint32_t(width), std::uint32_t(height), 4, {}};
    picture.codes.resize(std::size_t{4} * picture.width_px * picture.height_px);
    if (!WebPDecodeRGBAInto(file.data(), file.size(), picture.codes.data(), picture.codes.size(), 4 * width))
        throw InputError(source + " is damaged or cut short");
    return picture;
}

}  // namespace voxtone::io

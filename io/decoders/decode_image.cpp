// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/decoders/decode_image.h"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "base/error.h"
#include "io/decoders/decode_jpeg.h"
#include "io/decoders/decode_png.h"
#include "io/decoders/decode_webp.h"
#include "io/files/file_reader.h"
#include "io/files/xml_reader.h"

namespace voxtone::io {

namespace {

struct Magic {
    const char* format;  // as OpenImageIO names it
    std::string_view mark;
    std::size_t at = 0;
};

using namespace std::string_view_literals;
constexpr Magic magics[] = {
    {"png", "\x89PNG\r\n\x1a\n"sv},
    {"jpeg", "\xff\xd8\xff"sv},
    {"tiff", "II*\0"sv},
    {"tiff", "MM\0*"sv},
    {"tiff", "II+\0"sv},
    {"tiff", "MM\0+"sv},
    {"bmp", "BM"sv},
    {"openexr", "\x76\x2f\x31\x01"sv},
    {"hdr", "#?RADIANCE"sv},
    {"hdr", "#?RGBE"sv},
    {"webp", "WEBP"sv, 8},
    {"gif", "GIF8"sv},
    {"psd", "8BPS"sv},
    {"pnm", "P1"sv},
    {"pnm", "P2"sv},
    {"pnm", "P3"sv},
    {"pnm", "P4"sv},
    {"pnm", "P5"sv},
    {"pnm", "P6"sv},
    {"pnm", "PF"sv},
    {"pnm", "Pf"sv},
};

/// In any case; the name may stand in quotes.
bool ends_like(std::string_view name, std::string_view ending) {
    if (name.ends_with('\'')) name.remove_suffix(1);
    return name.size() >= ending.size() &&
           std::ranges::equal(name.substr(name.size() - ending.size()), ending,
                              [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a + 32 : a) == b; });
}

}  // namespace

std::string picture_format(std::span<const std::byte> bytes, const std::string& name) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    for (const Magic& magic : magics)
        if (text.size() >= magic.at + magic.mark.size() && text.substr(magic.at, magic.mark.size()) == magic.mark)
            return magic.format;
    const bool packed = text.starts_with("\x1f\x8b"sv);
    if (root_element(text) == "svg" || ends_like(name, packed ? ".svgz" : ".svg")) return drawing_format;
    return ends_like(name, ".tga") || text.ends_with("TRUEVISION-XFILE.\0"sv) ? "targa" : "";
}

DecodedImage decode_image(std::span<const std::byte> bytes, const std::string& name, const DecodeOptions& options) {
    const std::string format = picture_format(bytes, name);
    if (format.empty())
        throw InputError(fmt::format(
            "{} is no picture of a known kind (PNG, JPEG, TIFF, BMP, TGA, GIF, WebP, EXR, HDR, PNM, PSD, SVG); save it "
            "as PNG",
            name));
    if (format == "png") return decode_png(bytes, name, options);
    if (format == "jpeg") return decode_jpeg(bytes, name, options);
    if (format == "webp") return decode_webp(bytes, name, options);
    if (format == drawing_format && !(options.drawing.pitch_mm > 0))
        throw InputError(
            fmt::format("{} is an SVG drawing, which has no pixels; on a model it may be a decal (--decal), and no "
                        "texture: save it as "
                        "PNG",
                        name));
    if (!options.others)
        throw InputError(
            fmt::format("pictures of the kind of {} ({}) cannot be read here; save it as PNG", name, format));
    return options.others(bytes, format, name, options);
}

}  // namespace voxtone::io

// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/openimageio/declared_size.h"

#include <algorithm>
#include <cstdint>

#include <fmt/format.h>

#include "base/error.h"
#include "io/decoders/picture_samples.h"

namespace voxtone::io {

namespace {

/// A GIF's canvas, which OpenImageIO takes memory for before it tells its size: two 16-bit numbers behind the mark.
void check_gif_canvas(std::span<const std::byte> bytes, const std::string& name, const DecodeOptions& options) {
    if (bytes.size() < 10) return;  // cut short: opening says so
    const auto number = [&](std::size_t at) { return std::to_integer<std::uint64_t>(bytes[at]); };
    const std::uint64_t width = number(6) + 256 * number(7), height = number(8) + 256 * number(9);
    check_picture_size(std::max<std::uint64_t>(width, 1), std::max<std::uint64_t>(height, 1), name, options);
}

/// The attributes of an OpenEXR header, for which OpenEXR takes as much memory as they declare: a name, a type, each
/// closed by 0, and a 32-bit length.
void check_exr_header(std::span<const std::byte> bytes, const std::string& name) {
    std::size_t at = 8;  // behind the mark and the version
    const auto skip_word = [&] {
        while (at < bytes.size() && bytes[at] != std::byte{}) ++at;
        ++at;
    };
    while (at < bytes.size() && bytes[at] != std::byte{}) {
        skip_word();
        skip_word();
        std::uint64_t length = 0;
        for (std::size_t i = 0; i < 4 && at + i < bytes.size(); ++i)
            length |= std::to_integer<std::uint64_t>(bytes[at + i]) << (8 * i);
        at += 4;
        if (at > bytes.size() || length > bytes.size() - at)
            throw InputError(fmt::format(
                "the picture {} declares more in its header than its {} bytes hold; it is damaged or cut short", name,
                bytes.size()));
        at += length;
    }
}

}  // namespace

void check_declared_size(std::span<const std::byte> bytes, const std::string& format, const std::string& name,
                         const DecodeOptions& options) {
    if (format == "gif") check_gif_canvas(bytes, name, options);
    if (format == "openexr") check_exr_header(bytes, name);
}

}  // namespace voxtone::io

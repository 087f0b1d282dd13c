// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/packed_image.h"

#include <cmath>

#include "base/error.h"

namespace voxtone::io {

void check_decoded(const DecodedImage& image) {
    const TexelImage& texels = image.texels;
    constexpr std::uint64_t most = std::uint64_t{1} << 60;
    const std::uint64_t pixels = std::uint64_t{texels.width_px} * texels.height_px;
    if (!(image.pixel_aspect > 0) || !std::isfinite(image.pixel_aspect))
        throw InputError("what the reader left is no picture: its pixels have no shape");
    if (pixels == 0 || pixels > most || texels.srgb8.empty() == texels.linear16.empty() ||
        texels.srgb8.size() + texels.linear16.size() != 4 * pixels)
        throw InputError("what the reader left is no picture: its size is not that of its pixels");
}

std::vector<std::byte> pack(const DecodedImage& image) { return packed(image); }

Packing packing_of(DecodedImage image) { return packing(std::move(image)); }

DecodedImage unpack_image(std::span<const std::byte> bytes) {
    PackedReader reader(bytes);
    return unpack_image(reader);
}

DecodedImage unpack_image(PackedReader& reader) {
    auto image = unpacked<DecodedImage>(reader);
    check_decoded(image);
    return image;
}

}  // namespace voxtone::io

// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/pictures/packed_image.h"

#include "voxtone/io/files/packed_values.h"

namespace voxtone::io {

std::vector<std::byte> pack(const DecodedImage& image) {
    PackedWriter writer;
    describe(writer, image);
    return std::move(writer.bytes);
}

DecodedImage unpack_image(std::span<const std::byte> bytes) {
    DecodedImage image;
    PackedReader reader(bytes);
    describe(reader, image);
    return image;
}

}  // namespace voxtone::io

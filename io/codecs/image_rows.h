// SPDX-License-Identifier: GPL-3.0-or-later
//
// All pixels of an opened picture, or none where some cannot be had.
//
// OpenImageIO 2.4 takes deflated TIFF strip by strip and does not look whether a strip is there and could be unpacked:
// of a file that was cut short it gives black. Row by row it goes through libtiff, which tells.
#pragma once

#include <OpenImageIO/imageio.h>

namespace voxtone::io {

/// The first `channels` as `type`, rows from the top. False: the file is damaged; `input` knows why.
[[nodiscard]] bool read_rows(OIIO::ImageInput& input, int channels, OIIO::TypeDesc type, void* pixels);

}  // namespace voxtone::io

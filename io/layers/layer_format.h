// SPDX-License-Identifier: GPL-3.0-or-later
//
// The formats that a layer stack is written in, and their names.
#pragma once

#include <array>

#include "base/named_values.h"

namespace voxtone::io {

enum class LayerFormat {
    png,   ///< the stack itself: one RGBA bitmap a layer, always written
    gcvf,  ///< container for Voxel Print
    tiff,  ///< one bitmap per resin and layer, TIFF
    png1,  ///< the same as PNG of one bit
    vdb,   ///< sparse volume
};

}  // namespace voxtone::io

template <>
struct voxtone::NamesOf<voxtone::io::LayerFormat> {
    using Format = io::LayerFormat;
    static constexpr auto table = std::to_array<Named<Format>>({{Format::png, "png"},
                                                                {Format::gcvf, "gcvf"},
                                                                {Format::tiff, "tiff"},
                                                                {Format::png1, "png1"},
                                                                {Format::vdb, "vdb"}});
};

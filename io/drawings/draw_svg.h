// SPDX-License-Identifier: GPL-3.0-or-later
//
// SVG drawings as pixels, by librsvg and cairo, as many as the print has places for: they are sharp at any size.
//
// A drawing is as large as it says in mm, in, pt ...; what it counts in px (or in units of its viewBox, or not at all)
// is 1/96 inch each, as CSS has it, or what `DrawingRaster::px_per_inch` says. Files that it names are not opened, and
// text is set in fonts of this machine: what comes of that is said (svg_facts.h). Colours are sRGB, edges are shares of
// pixels as alpha.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "io/decoders/decode_options.h"

namespace voxtone::io {

/// SVG, or SVG that gzip packed (.svgz). Throws InputError.
[[nodiscard]] DecodedImage draw_svg(std::span<const std::byte> bytes, const std::string& name,
                                    const DecodeOptions& options);

}  // namespace voxtone::io

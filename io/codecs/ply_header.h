// SPDX-License-Identifier: GPL-3.0-or-later
//
// The header of a PLY file: declared sizes are checked against the file's length before a parser believes them, and
// what carries colour is noted.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace voxtone::io {

struct PlyHeader {
    bool integer_colours = true;  ///< vertex colours are sRGB codes; false: floats, linear
    bool face_colours = false;
    std::string texture_file;  ///< `comment TextureFile NAME`
};

/// Throws InputError on a header that is no PLY or declares more than the file can hold.
[[nodiscard]] PlyHeader read_ply_header(std::span<const std::byte> bytes, const std::string& name);

}  // namespace voxtone::io

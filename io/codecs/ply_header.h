// SPDX-License-Identifier: GPL-3.0-or-later
//
// The header of a PLY file: declared sizes are checked against the file's length before a parser believes them. Lines
// may end in LF, CRLF or CR, and a byte order mark may come first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace voxtone::io {

enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

[[nodiscard]] constexpr std::size_t bytes_of(PlyType type) {
    constexpr std::size_t bytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    return bytes[static_cast<std::size_t>(type)];
}
[[nodiscard]] constexpr bool is_float(PlyType type) { return type >= PlyType::float32; }

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::uint8;  ///< of its value; of a list's items
    bool is_list = false;
    PlyType count_type = PlyType::uint8;  ///< of a list's length
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    enum class Encoding { ascii, little_endian, big_endian };
    Encoding encoding = Encoding::ascii;
    std::vector<PlyElement> elements;
    std::size_t bytes = 0;                   ///< of the header; items begin behind it
    std::vector<std::string> texture_files;  ///< `comment TextureFile NAME`, in their order
};

/// Throws InputError on a header that is no PLY or declares more than the file can hold.
[[nodiscard]] PlyHeader read_ply_header(std::span<const std::byte> bytes, const std::string& name);

/// What a property is, by the names that programs give it, in any case.
enum class PlyRole : char { none, red, green, blue, alpha, x, y, z, u, v, corners, corner_uv, page, material };

/// Of an element's properties. Where there are several kinds of colours one is taken: plain ones before diffuse ones,
/// and those before ambient ones.
[[nodiscard]] std::vector<PlyRole> ply_roles(const PlyElement& element);
/// Whether its items are Gaussian splats, plain or as PlayCanvas packs them.
[[nodiscard]] bool ply_holds_splats(const PlyElement& element);
/// A property that is a colour by its name where ply_roles finds none; empty: there is none.
[[nodiscard]] std::string ply_unread_colour(const PlyElement& element);

}  // namespace voxtone::io

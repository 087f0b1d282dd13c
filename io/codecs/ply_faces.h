// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a PLY file says of its faces and assimp does not hand on: a colour for each, and texture coordinates for each of
// its corners (assimp keeps one per vertex, so that seams tear).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "voxtone/io/codecs/ply_header.h"

namespace voxtone::io {

struct PlyFaces {
    std::vector<std::size_t> first_corner;  ///< per face, and one behind the last
    std::vector<std::uint32_t> vertex;      ///< per corner
    std::vector<Eigen::Vector4f> rgba;      ///< per face, linear; or empty
    std::vector<Eigen::Vector2f> uv;        ///< per corner; or empty

    [[nodiscard]] std::size_t size() const { return first_corner.empty() ? 0 : first_corner.size() - 1; }
    /// Some face differs from another.
    [[nodiscard]] bool has_several_colours() const;
    /// Where in `vertex` a face has this vertex; nothing: none of its corners.
    [[nodiscard]] bool has_corners(std::size_t face, const std::array<std::uint32_t, 3>& triangle) const;
    [[nodiscard]] Eigen::Vector2f uv_at(std::size_t face, std::uint32_t vertex) const;
};

/// Throws InputError where a list is longer than what is left of the file: a parser would take memory for it.
void expect_lists_to_fit(std::span<const std::byte> bytes, const PlyHeader& header, const std::string& name);

/// In the order of the file. Throws InputError where it is cut short.
[[nodiscard]] PlyFaces read_ply_faces(std::span<const std::byte> bytes, const PlyHeader& header,
                                      const std::string& name);

}  // namespace voxtone::io

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The statements of an OBJ file as plain values, one array a kind; what they mean together is parse_obj.h's. Words may
// be in upper or lower case, behind blanks and before comments; backwards indices are counted already.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace voxtone::io {

/// What stands behind the place of a vertex.
struct ObjVertexExtra {
    std::array<float, 5> value{};
    std::uint8_t count = 0;
};

/// From 0; -1: it has none.
struct ObjCorner {
    std::int64_t vertex = 0, uv = -1;
};

/// At least three corners, some of ObjFile::corners.
struct ObjFace {
    std::uint32_t material = 0;
    std::size_t first = 0, corners = 0, line = 0;
};

struct ObjFile {
    std::vector<Eigen::Vector3d> positions;
    std::vector<ObjVertexExtra> extras;    ///< per vertex up to the last that has some; empty: none has
    std::vector<std::uint32_t> polypaint;  ///< #MRGB: 0xMMRRGGBB per vertex
    std::vector<Eigen::Vector2f> uv;
    std::vector<ObjCorner> corners;
    std::vector<ObjFace> faces;
    std::vector<std::string> materials{""};        ///< names, as faces use them
    std::vector<std::size_t> libraries_before{0};  ///< of the names: how many `libraries` stand before their use
    std::vector<std::string> libraries;            ///< what stands behind each mtllib that is not the one before again
    std::size_t points_and_lines = 0, free_forms = 0;
    bool comma = false;  ///< numbers have decimal commas

    [[nodiscard]] std::span<const ObjCorner> corners_of(const ObjFace& face) const {
        return std::span(corners).subspan(face.first, face.corners);
    }
};

/// `text`: as model_text gives it. Every index of a face is one of the file. Throws InputError, which begins with
/// `name` and the line.
[[nodiscard]] ObjFile read_obj(std::string_view text, const std::string& name);

}  // namespace voxtone::io

// SPDX-License-Identifier: GPL-3.0-or-later
//
// A mark: something laid onto a part's surface, a text, a code or a picture. Labels and decals are marks.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include <Eigen/Core>

namespace voxtone::slicer {

enum class MarkKind : std::uint8_t { text, qr, data_matrix, gs1_data_matrix, gs1_qr, gs1_128, picture };
[[nodiscard]] constexpr bool is_code(MarkKind kind) { return kind != MarkKind::text && kind != MarkKind::picture; }
[[nodiscard]] constexpr bool is_gs1(MarkKind kind) {
    return kind == MarkKind::gs1_data_matrix || kind == MarkKind::gs1_qr || kind == MarkKind::gs1_128;
}

/// `unseen`: where it is least in the way of what the print shows: the bottom, the back, then a side, of a picture its
/// back, then its rim. `flattest`: where a face of the mark's size is flattest. As a viewer stands before the print:
/// front faces -y.
enum class MarkSide : std::uint8_t { unseen, flattest, front, back, left, right, top, bottom };

/// A rectangle of the model's texture coordinates.
struct UvRectangle {
    double left = 0, bottom = 0, right = 0, top = 0;
};

/// A side, the surface nearest to a point (mm from the corner of the print's box), or a rectangle of the texture.
using MarkPlace = std::variant<MarkSide, Eigen::Vector3d, UvRectangle>;

/// `contrast`: black or white, whichever tells more from what it lies on. `none`: no colour, only a relief.
enum class MarkInk : std::uint8_t { contrast, colour, none };

struct MarkOptions {
    MarkKind kind = MarkKind::text;
    std::string text;  ///< of texts and codes, UTF-8; lines are parted by '\n'
    std::string file;  ///< of pictures
    std::string font;  ///< name or file; of texts
    MarkPlace place = MarkSide::unseen;
    std::optional<Eigen::Vector2d> at_mm;  ///< from the middle of a side, to the right and up; nothing: see lay_marks.h
    double size_mm =
        0;  ///< of texts the em; of codes the edge, of bars the width, without the quiet zone; of pictures the width
    double turn_deg = 0;  ///< anticlockwise
    MarkInk ink = MarkInk::contrast;
    Eigen::Vector3f ink_rgb = Eigen::Vector3f::Zero();  ///< linear sRGB
    std::string
        resin;  ///< role: the ink is of this resin alone, as deep as the shell; empty: a mixture makes its colour
    std::optional<Eigen::Vector3f> ground_rgb;  ///< of its whole rectangle; nothing: what is there stays
    int relief_voxels = 0;                      ///< above 0 the ink is raised so far, below it is engraved
    std::string said;                           ///< as it was spelled, for messages: "--label 'A-17'"
};

}  // namespace voxtone::slicer

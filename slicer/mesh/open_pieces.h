// SPDX-License-Identifier: GPL-3.0-or-later
//
// What an open mesh is a part of: a body with holes, a sheet that encloses nothing, or a body of which so much is
// missing that nobody can tell its shape.
//
// A piece is what is joined through edges, or by a hole between (hole_filling.h). It is a body where the fill is at
// most a third of its own area; or where its holes are flat, all of it lies on one side of them, and it leaves them at
// more than 30 degrees: the missing floor of a box, a dome, a relief with side walls. Of the rest it is a sheet where
// the fill is more than 0.7 of its own area (a terrain without a base, a cape), and torn between. Filling a sheet gives
// a body as lumpy as the sheet is hilly.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "slicer/mesh/hole_filling.h"
#include "slicer/mesh/solid_mesh.h"

namespace voxtone::slicer {

struct OpenPiece {
    enum class Kind : std::uint8_t { body, sheet, torn };
    Kind kind = Kind::body;
    double own_mm2 = 0, fill_mm2 = 0;
    std::vector<std::uint32_t> faces;  ///< triangles
    std::vector<std::uint32_t> fills;  ///< holes of it; at least one
};

/// Those pieces of a mesh that have holes. `fills`: all that fill_holes made of it.
[[nodiscard]] std::vector<OpenPiece> open_pieces(std::span<const Eigen::Vector3d> positions,
                                                 std::span<const Triangle> triangles, std::span<const HoleFill> fills);

/// Closes a piece without filling its holes: by its own faces turned round, `thickness_mm` behind it (0: in its place)
/// and joined to it along its edges. What is added has the source of the face that it lies behind or at.
void add_other_side(SolidMesh& mesh, const OpenPiece& piece, double thickness_mm);

}  // namespace voxtone::slicer

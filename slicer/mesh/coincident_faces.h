// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bodies that a file holds several times in one place, and bodies whose faces it holds once for each side.
//
// To winding numbers k copies of a body are one that winds k times: the same solid, but all pairs of its faces touch,
// which takes k^2 times the work and fills the cavities of its first copy. A face and its back side cancel: a body
// drawn so ("two-sided", as exporters for games do) winds around nothing, and nothing of it would be printed but a
// film.
//
// A shell (faces joined through edges, corners told by their place) is made simple where that leaves a body: where
// all its faces are there equally often more one way round than the other, each stays once; where all are there as
// often one way as the other, one of each stays, turned to face outward, but for faces that two such bodies share. What
// is left of the second kind may have holes (open_pieces.h). Anything else is left as it is: bodies that share a part
// of their faces, sheets with a back side.
//
// Own code: CGAL's merge_duplicated_polygons_in_polygon_soup erases either all or all but one of such faces wherever
// they are, which opens bodies that share a face.
#pragma once

#include <cstddef>
#include <vector>

#include "slicer/mesh/face_sides.h"
#include "slicer/mesh/solid_mesh.h"

namespace voxtone::slicer {

struct CoincidentFaces {
    std::size_t copies = 0;        ///< faces dropped that lay on one of the same side
    std::size_t back_sides = 0;    ///< faces dropped of two-sided shells
    double sheet_mm2 = 0;          ///< of two-sided shells that enclose nothing and were left, one side of them
    std::vector<PiledFace> piled;  ///< all that lay on others where some were dropped, those that were kept, too
};

/// Positions must be equal to the last bit to be one place. Of faces that are one, some stays; which one's colour
/// counts is face_sides.h's. Corners of what is made simple are joined where they are in one place. `sheets`: two-sided
/// sheets lose a side, too. Time n log n.
[[nodiscard]] CoincidentFaces drop_coincident_faces(SolidMesh& mesh, bool sheets = false);

}  // namespace voxtone::slicer

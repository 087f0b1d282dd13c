// SPDX-License-Identifier: GPL-3.0-or-later
//
// Volumes of a model that are to be cut out of others (slicers' negative volumes), by CGAL's boolean operations.
#pragma once

#include <cstddef>
#include <vector>

#include "io/models/model_parts.h"

namespace voxtone::io {

struct TriangleRange {
    std::size_t first = 0, last = 0;  ///< triangles from `first` up to and without `last`
};

/// What one object is made of: each range closed, bodies and what is cut out of every one of them.
struct VolumeCut {
    std::vector<TriangleRange> bodies, tools;
};

/// Replaces each body by what the tools leave of it, and takes the tools away. What is left of a triangle keeps its
/// colours, interpolated; the walls of a cut have the body's colour where it has one only, else they are white, which
/// is said. A tool that touches a wall from within, so that what is left would be no surface, is taken larger by a
/// millionth of the body. Numbers of triangles change. Throws InputError naming `model` where a volume is not closed or
/// crosses itself.
void cut_volumes(ModelParts& parts, const std::vector<VolumeCut>& cuts, const std::string& model);

}  // namespace voxtone::io

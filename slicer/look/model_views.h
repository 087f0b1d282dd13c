// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a model looks like as its file has it, before anything is done with it: one picture, to recognise it by.
#pragma once

#include "base/progress.h"
#include "io/models/mesh.h"
#include "io/pictures/picture_writer.h"

namespace voxtone::slicer {

constexpr int least_views_px = 96, most_views_px = 4096;

/// A body from the three-quarter view, the front and above, side by side in one scale, lit; a picture's slab from above
/// with its own colours. At most `width_px` wide, in [least_views_px, most_views_px]; positions are in mm. Nothing
/// covers what lies beside it. Throws Cancelled.
[[nodiscard]] io::LinearPicture model_views(const io::TexturedMesh& mesh_mm, bool is_picture, int width_px,
                                            const Progress* progress = nullptr);

}  // namespace voxtone::slicer

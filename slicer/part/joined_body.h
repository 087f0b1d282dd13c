// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bodies of one print as one body: their solids are united, and what of their surfaces lies in another of them is
// neither seen nor coloured (surface/visible_surface.h). Light passes from one to the other where the voxels do.
//
// Each keeps its own repair, its materials and its place on the grid of voxels, so that the voxels of the whole are
// those of its parts but for rounding (1e-12 of a coordinate), where they do not overlap.
#pragma once

#include <array>
#include <span>

#include "base/progress.h"
#include "slicer/part/job_body.h"

namespace voxtone::slicer {

struct BodyAt {
    const JobBody* body = nullptr;
    std::array<int, 3> at{};  ///< voxels from the corner of the whole, >= 0
};

/// Contract: there is a body, none is a picture, all have one pitch. Beside the model no files are named: who asks for
/// the identity of the whole adds what its parts are made of. Throws what find_visible_surface throws.
[[nodiscard]] JobBody join_bodies(std::span<const BodyAt> bodies, Progress& progress);

}  // namespace voxtone::slicer

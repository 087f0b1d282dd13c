// SPDX-License-Identifier: GPL-3.0-or-later
//
// The mesh that a stack of ours was printed from, as the boundary of its body for light paths: the job.json beside the
// layers names the model and says how it was placed. The model counts as the same where it and all files beside it hold
// what they held then (SHA-256), and where it fills the same voxel grid.
#pragma once

#include <optional>
#include <string>

#include "base/progress.h"
#include "slicer/mesh/mesh_boundary.h"
#include "slicer/part/job_body.h"
#include "slicer/predict/stack_volume.h"

namespace voxtone::slicer {

/// The body that a stack was made of, as its job had it; pictures' slabs too.
struct StackBody {
    std::optional<JobBody> body;
    std::string why_not;  ///< half a sentence, where nothing
};
/// `stack`: the output folder. Reads the model again, as the job did. Throws Cancelled.
[[nodiscard]] StackBody body_of_stack(const std::string& stack, const StackVolume& volume, Progress& progress);

struct StackBoundary {
    std::optional<MeshBoundary> mesh;  ///< nothing: the faces of the voxels have to do
    std::string why_not;               ///< half a sentence, where nothing
};

/// The same, for bodies. Throws Cancelled.
[[nodiscard]] StackBoundary boundary_of_stack(const std::string& stack, const StackVolume& volume, Progress& progress);

}  // namespace voxtone::slicer

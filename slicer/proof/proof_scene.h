// SPDX-License-Identifier: GPL-3.0-or-later
//
// A stack as bodies before a camera: the print within its true surface, and beside it, if wanted, its target.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "voxtone/base/progress.h"
#include "voxtone/optics/camera/camera_scene.h"
#include "voxtone/slicer/mesh/mesh_boundary.h"
#include "voxtone/slicer/predict/stack_volume.h"
#include "voxtone/slicer/proof/diffuse_mesh.h"
#include "voxtone/slicer/proof/proof_options.h"
#include "voxtone/slicer/proof/support_contact.h"

namespace voxtone::slicer {

/// Does not move once made: its parts refer to each other.
struct ProofScene {
    StackVolume stack;
    optics::Scene scene;
    std::optional<MeshBoundary> boundary;
    std::string boundary_is;  ///< "mesh", "box" or "cells"
    std::unique_ptr<const optics::SurfaceFinish> finish;
    std::vector<std::unique_ptr<const DiffuseMesh>> target;
    optics::Sky sky = optics::even_sky();
    optics::CameraScene camera;
};

/// What is wrong is said before much is read. Throws FileError, InputError, ResourceError, Cancelled.
[[nodiscard]] std::unique_ptr<const ProofScene> make_proof_scene(const ResolvedProof& job, Progress& progress);

}  // namespace voxtone::slicer

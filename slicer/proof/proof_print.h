// SPDX-License-Identifier: GPL-3.0-or-later
//
// A stack as a body before a camera: its voxels within their true surface.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "optics/camera/camera_scene.h"
#include "slicer/mesh/mesh_boundary.h"
#include "slicer/predict/stack_boundary.h"
#include "slicer/proof/diffuse_mesh.h"
#include "slicer/proof/proof_camera.h"

namespace voxtone::slicer {

/// Does not move once made: its parts refer to each other.
struct ProofPrint {
    StackVolume stack;
    optics::Scene scene;
    StackBody body;  ///< what it was made of, where that can be had
    std::optional<MeshBoundary> boundary;
    std::string boundary_is;  ///< "mesh", "box" or "cells"
    std::vector<Box> boxes;   ///< that the body is made of, where it is; mm from the corner of its volume
    std::unique_ptr<const optics::SurfaceFinish> finish;
    Box box;                                             ///< in the model's frame
    Eigen::Vector3d moved_mm = Eigen::Vector3d::Zero();  ///< from there, to where it stands
};

/// Throws FileError, InputError, ResourceError, Cancelled.
[[nodiscard]] std::unique_ptr<ProofPrint> make_print(const ResolvedProof& job, const std::string& stack,
                                                     Progress& progress);

/// The print's model, moved so far, as diffusers below the print's finish. Throws InputError where it cannot be had,
/// Cancelled.
[[nodiscard]] std::vector<std::unique_ptr<const DiffuseMesh>> make_target(const ProofPrint& print,
                                                                          const Eigen::Vector3d& moved_mm,
                                                                          Progress& progress);

}  // namespace voxtone::slicer

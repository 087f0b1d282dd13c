// SPDX-License-Identifier: GPL-3.0-or-later
//
// A mesh with vertex colours as a diffuser for the camera: the target beside its print.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "io/models/coloured_mesh.h"
#include "optics/camera/camera_scene.h"
#include "slicer/mesh/mesh_boundary.h"

namespace voxtone::slicer {

class DiffuseMesh : public optics::DiffuseBody {
public:
    /// `moved_mm`: by so much from where the mesh has it. Colours are multiplied by `white`.
    DiffuseMesh(const io::ColouredMesh& mesh, const Eigen::Vector3d& moved_mm, const Eigen::Vector3d& white);

    [[nodiscard]] bool meets(const optics::Point& from, const optics::Point& way, double& distance,
                             optics::BoundaryNormals& normals, optics::Light& reflectance) const override;

private:
    std::vector<Eigen::Vector3f> rgb_;
    MeshBoundary mesh_;
};

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
//
// A mesh with vertex colours as a diffuser for the camera, as glossy as the print: the target beside it.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "io/models/coloured_mesh.h"
#include "optics/camera/camera_scene.h"
#include "slicer/mesh/mesh_boundary.h"

namespace voxtone::slicer {

class DiffuseMesh : public optics::DiffuseBody {
public:
    /// What lies over it: the index of the print's resins, and its finish.
    struct Gloss {
        double eta = 1;
        const optics::SurfaceFinish* finish = nullptr;        ///< must outlive the mesh
        Eigen::Vector3d corner_mm = Eigen::Vector3d::Zero();  ///< of the volume that the finish is of, where it stands
    };
    /// `moved_mm`: by so much from where the mesh has it. Colours are multiplied by `white`.
    DiffuseMesh(const io::ColouredMesh& mesh, const Eigen::Vector3d& moved_mm, const Eigen::Vector3d& white,
                const Gloss& gloss);

    [[nodiscard]] bool meets(const optics::Point& from, const optics::Point& way, double& distance,
                             optics::BoundaryNormals& normals, optics::Light& reflectance) const override;
    [[nodiscard]] optics::Coat coat(const optics::Point& at, const optics::Point& outward) const override;

private:
    std::vector<Eigen::Vector3f> rgb_;
    MeshBoundary mesh_;
    Gloss gloss_;
    double mean_;
};

}  // namespace voxtone::slicer

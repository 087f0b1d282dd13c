// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/proof/diffuse_mesh.h"

#include <algorithm>

#include "optics/camera/lit_scene.h"

namespace voxtone::slicer {

namespace {

std::vector<Eigen::Vector3d> places(const io::ColouredMesh& mesh) {
    std::vector<Eigen::Vector3d> out;
    out.reserve(mesh.positions_mm.size());
    for (const Eigen::Vector3f& p : mesh.positions_mm) out.push_back(p.cast<double>());
    return out;
}

}  // namespace

DiffuseMesh::DiffuseMesh(const io::ColouredMesh& mesh, const Eigen::Vector3d& moved_mm, const Eigen::Vector3d& white,
                         const Gloss& gloss)
    : mesh_(places(mesh), mesh.triangles, -moved_mm), gloss_(gloss), mean_(optics::mean_reflectance(gloss.eta)) {
    rgb_.reserve(mesh.rgb.size());
    for (const Eigen::Vector3f& rgb : mesh.rgb)
        rgb_.emplace_back(rgb.cwiseProduct(white.cast<float>()).cwiseMax(0.0f).cwiseMin(1.0f));
}

optics::Coat DiffuseMesh::coat(const optics::Point& at, const optics::Point& outward) const {
    const optics::Point corner{gloss_.corner_mm.x(), gloss_.corner_mm.y(), gloss_.corner_mm.z()};
    return {gloss_.eta, gloss_.finish ? gloss_.finish->roughness(optics::along(at, corner, -1), outward) : 0, mean_};
}

bool DiffuseMesh::meets(const optics::Point& from, const optics::Point& way, double& distance,
                        optics::BoundaryNormals& normals, optics::Light& reflectance) const {
    const auto met = mesh_.triangle_met(from, way);
    if (!met) return false;
    distance = met->distance;
    normals = met->normals;
    Eigen::Vector3f rgb = Eigen::Vector3f::Zero();
    for (std::size_t c = 0; c < 3; ++c) rgb += met->weights[c] * rgb_[met->corners[c]];
    for (std::size_t c = 0; c < 3; ++c) reflectance[c] = std::clamp(double(rgb[static_cast<int>(c)]), 0.0, 1.0);
    return true;
}

}  // namespace voxtone::slicer

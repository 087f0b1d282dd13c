// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/surface_colour.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "base/parallel.h"
#include "io/pictures/texture.h"
#include "optics/layered/translucency_alpha.h"

namespace voxtone::slicer {

namespace {

bool has_texture(const io::TexturedMesh& mesh) {
    return !mesh.corner_uv.empty() &&
           std::any_of(mesh.materials.begin(), mesh.materials.end(), [](const auto& m) { return bool(m.texture); });
}

bool one_colour(const io::TexturedMesh& mesh) {
    if (has_texture(mesh)) return false;
    const auto corner_colour = [&](std::size_t triangle, std::size_t corner) -> Eigen::Vector3f {
        const Eigen::Vector3f rgb = mesh.materials[mesh.material_of_triangle[triangle]].rgb;
        return mesh.corner_rgb.empty() ? rgb : Eigen::Vector3f(rgb.cwiseProduct(mesh.corner_rgb[triangle][corner]));
    };
    const Eigen::Vector3f first = corner_colour(0, 0);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t c = 0; c < 3; ++c)
            if (corner_colour(t, c) != first) return false;
    return true;
}

}  // namespace

bool has_alpha(const io::TexturedMesh& mesh) {
    const auto below_one = [](float alpha) { return alpha < 1; };
    return std::ranges::any_of(mesh.materials,
                               [&](const auto& m) { return below_one(m.alpha) || bool(m.alpha_texture); }) ||
           std::ranges::any_of(mesh.corner_alpha,
                               [&](const auto& corners) { return std::ranges::any_of(corners, below_one); });
}

SurfaceColour::SurfaceColour(const io::TexturedMesh& mesh, double sample_spacing_mm, std::vector<int> resin_of_decal)
    : mesh_(mesh),
      sample_spacing_mm_(sample_spacing_mm),
      resin_of_decal_(std::move(resin_of_decal)),
      constant_(mesh.decals.empty() && one_colour(mesh)),
      has_alpha_(slicer::has_alpha(mesh)) {
    if (!has_texture(mesh)) return;
    lod_.resize(mesh.triangles.size());
    parallel_for(0, mesh.triangles.size(), 4096, [&](std::size_t t) {
        const io::Texture* texture = mesh.materials[mesh.material_of_triangle[t]].texture.get();
        if (!texture) return;
        const auto& corners = mesh.triangles[t];
        lod_[t] = texture->lod(mesh.corner_uv[t],
                               {mesh.positions[corners[0]], mesh.positions[corners[1]], mesh.positions[corners[2]]},
                               sample_spacing_mm);
    });
}

Eigen::Vector3f SurfaceColour::at(std::uint32_t triangle, float u, float v) const {
    const Eigen::Vector3f rgb = below_decals(triangle, u, v);
    return mesh_.decals.empty() ? rgb : under_decals(triangle, u, v, rgb);
}

float SurfaceColour::alpha_at(std::uint32_t triangle, float u, float v) const {
    if (!has_alpha_) return 1;
    const io::SurfaceMaterial& material = mesh_.materials[mesh_.material_of_triangle[triangle]];
    float alpha = material.alpha;
    // Differences: where all corners are 1, so is what lies between.
    if (!mesh_.corner_alpha.empty()) {
        const auto& [a, b, c] = mesh_.corner_alpha[triangle];
        alpha *= a + u * (b - a) + v * (c - a);
    }
    if (material.alpha_texture && !mesh_.corner_uv.empty()) {
        const auto& [a, b, c] = mesh_.corner_uv[triangle];
        const Eigen::Vector2f uv = a + u * (b - a) + v * (c - a);
        alpha *= material.alpha_texture->sample(uv.x(), uv.y(), lod_[triangle]).x();
    }
    if (material.times_as_large != 1) {
        const double eta = optics::translucency_eta_per_cm(std::clamp(double(alpha), 0.0, 1.0));
        alpha = static_cast<float>(optics::translucency_alpha(eta / material.times_as_large));
    }
    for_each_decal(triangle, u, v,
                   [&](std::size_t, const Eigen::Vector4f& over) { alpha = over[3] + (1 - over[3]) * alpha; });
    return std::clamp(alpha, 0.0f, 1.0f);
}

template <class Visit>
void SurfaceColour::for_each_decal(std::uint32_t triangle, float u, float v, Visit visit) const {
    const auto& corner = mesh_.triangles[triangle];
    const Eigen::Vector3d& a = mesh_.positions[corner[0]];
    const Eigen::Vector3d along_u = mesh_.positions[corner[1]] - a, along_v = mesh_.positions[corner[2]] - a;
    const Eigen::Vector3d point = a + double(u) * along_u + double(v) * along_v;
    const Eigen::Vector3d area = along_u.cross(along_v);
    for (std::size_t d = 0; d < mesh_.decals.size(); ++d) {
        const io::Decal& decal = mesh_.decals[d];
        if (!decal.by_uv) {
            visit(d, decal.at(point, area.normalized(), sample_spacing_mm_));
        } else if (!mesh_.corner_uv.empty()) {
            const auto& uv = mesh_.corner_uv[triangle];
            const Eigen::Vector2f du = uv[1] - uv[0], dv = uv[2] - uv[0];
            const double uv_area = std::abs(double(du.x()) * double(dv.y()) - double(du.y()) * double(dv.x()));
            const double spacing = area.norm() > 0 ? sample_spacing_mm_ * std::sqrt(uv_area / area.norm()) : 0;
            visit(d, decal.at_uv(uv[0] + u * du + v * dv, spacing));
        }
    }
}

Eigen::Vector3f SurfaceColour::under_decals(std::uint32_t triangle, float u, float v, Eigen::Vector3f rgb) const {
    for_each_decal(triangle, u, v,
                   [&](std::size_t, const Eigen::Vector4f& over) { rgb = over.head<3>() + (1 - over[3]) * rgb; });
    return rgb;
}

int SurfaceColour::resin_at(std::uint32_t triangle, float u, float v) const {
    int resin = -1;
    for_each_decal(triangle, u, v, [&](std::size_t d, const Eigen::Vector4f& over) {
        if (over[3] > 0.5f) resin = d < resin_of_decal_.size() ? resin_of_decal_[d] : -1;
    });
    return resin;
}

Eigen::Vector3f SurfaceColour::below_decals(std::uint32_t triangle, float u, float v) const {
    const io::SurfaceMaterial& material = mesh_.materials[mesh_.material_of_triangle[triangle]];
    Eigen::Vector3f rgb = material.rgb;
    const float w = 1 - u - v;
    if (!mesh_.corner_rgb.empty()) {
        const auto& corner = mesh_.corner_rgb[triangle];
        rgb = rgb.cwiseProduct(w * corner[0] + u * corner[1] + v * corner[2]);
    }
    if (material.texture && !mesh_.corner_uv.empty()) {
        const auto& corner = mesh_.corner_uv[triangle];
        const Eigen::Vector2f uv = w * corner[0] + u * corner[1] + v * corner[2];
        rgb = rgb.cwiseProduct(material.texture->sample(uv.x(), uv.y(), lod_[triangle]));
    }
    return rgb.cwiseMax(0.0f).cwiseMin(1.0f);
}

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The colour that was asked for at a point of the surface: material * corner colour * texture, in linear sRGB
// (io/models/mesh.h), decals over it. Textures and decals are filtered at the level whose texels are as wide as
// `sample_spacing_mm` on this triangle.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "io/models/mesh.h"

namespace voxtone::slicer {

/// Whether alpha is kept beside the colours, and is below 1 anywhere.
[[nodiscard]] bool has_alpha(const io::TexturedMesh& mesh);

class SurfaceColour {
public:
    /// Keeps a reference to the mesh, whose positions are in mm.
    /// `resin_of_decal`: by which resin alone the ink of each decal is printed, -1: by a mixture; empty: all by
    /// mixtures.
    SurfaceColour(const io::TexturedMesh& mesh, double sample_spacing_mm, std::vector<int> resin_of_decal = {});

    /// Point corner0 + u (corner1 - corner0) + v (corner2 - corner0) of a triangle of the mesh; linear sRGB in [0, 1].
    [[nodiscard]] Eigen::Vector3f at(std::uint32_t triangle, float u, float v) const;

    /// What of alpha was kept beside the colours, in [0, 1]; a decal is opaque where it covers.
    [[nodiscard]] float alpha_at(std::uint32_t triangle, float u, float v) const;
    /// Whether that is below 1 anywhere.
    [[nodiscard]] bool has_alpha() const { return has_alpha_; }

    /// Whether some decal is printed by a resin alone.
    [[nodiscard]] bool sets_resins() const { return !resin_of_decal_.empty(); }
    /// The resin of the uppermost decal that covers more than half at this point; -1: none, or it is a mixture's.
    [[nodiscard]] int resin_at(std::uint32_t triangle, float u, float v) const;

    /// True when every point has the same colour (a model without texture and with one material).
    [[nodiscard]] bool constant() const { return constant_; }

private:
    /// What each decal covers the point with, one after the other.
    template <class Visit>
    void for_each_decal(std::uint32_t triangle, float u, float v, Visit visit) const;
    [[nodiscard]] Eigen::Vector3f below_decals(std::uint32_t triangle, float u, float v) const;
    [[nodiscard]] Eigen::Vector3f under_decals(std::uint32_t triangle, float u, float v, Eigen::Vector3f rgb) const;

    const io::TexturedMesh& mesh_;
    double sample_spacing_mm_;
    std::vector<float> lod_;  ///< per triangle; empty without textures
    std::vector<int> resin_of_decal_;
    bool constant_ = false, has_alpha_ = false;
};

}  // namespace voxtone::slicer

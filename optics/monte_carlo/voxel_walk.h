// SPDX-License-Identifier: GPL-3.0-or-later
//
// A ray's way from voxel to voxel, in plain double precision: what the plain tracers have in common.
#pragma once

#include <array>
#include <vector>

#include "optics/monte_carlo/path_random.h"
#include "optics/scene/appearance_model.h"

namespace voxtone::optics {

/// A ray within a voxel.
struct Ray {
    std::array<int, 3> voxel{};
    std::array<double, 3> at{};  ///< in mm from the voxel's corner, 0 .. pitch; exact at the voxel's sides
    std::array<double, 3> d{};   ///< unit length
    Material material = air;
};

/// What stopped a ray.
struct Stop {
    bool at_surface = false;  ///< the ray stands at the side of its voxel, towards air; else its depth is used up
    std::size_t axis = 0;     ///< of that side's normal
    bool on_sheet = false;    ///< it looks down from the plane z = 0
};

/// Turns d by an angle of Henyey and Greenstein of mean cosine g.
void turn_henyey_greenstein(std::array<double, 3>& d, double g, PathRandom& random);

class VoxelWalk {
public:
    explicit VoxelWalk(const Scene& scene);

    struct Optics {
        std::array<double, 256> sigma_t{}, albedo{};  ///< per material, as its own g wants them
    };
    [[nodiscard]] const Optics& optics(std::size_t channel) const { return channels_[channel]; }
    /// Of a material; of air the set's.
    [[nodiscard]] double eta(Material material) const { return eta_[material]; }
    [[nodiscard]] double g(Material material) const { return g_[material]; }

    /// A ray at the place (u, v) of a face, without a direction.
    [[nodiscard]] Ray at_face(const SurfaceFace& face, double u, double v) const;

    /// Flies on until the optical depth is used up or the surface is met; mirrors turn it. `depth` gets what is left;
    /// `meetings` counts surfaces and mirrors.
    Stop advance(Ray& ray, const Optics& optics, double& depth, std::uint32_t& meetings) const;

    /// Turns the ray by an angle of Henyey and Greenstein, as the resin does that it is in.
    void scatter(Ray& ray, PathRandom& random) const { turn_henyey_greenstein(ray.d, g_[ray.material], random); }

private:
    const ResinVolume& volume_;
    Sides sides_;
    std::array<double, 256> eta_{}, g_{};
    std::vector<Optics> channels_;
};

/// Share of the flux reflected for a ray in the resin with cosine nu to the normal; 1 beyond the critical angle.
[[nodiscard]] double internal_reflectance(double nu, double eta);

/// The direction in the resin of a ray of diffuse light that the surface lets in. Its normal lies along `axis`,
/// `inward` is 1 or -1.
[[nodiscard]] std::array<double, 3> entering_light(std::size_t axis, double inward, double eta, PathRandom& random);

}  // namespace voxtone::optics

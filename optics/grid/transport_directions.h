// SPDX-License-Identifier: GPL-3.0-or-later
//
// The 64 directions of the transport predictor, and what a face of the voxel staircase does to them.
//
// One octant has 8 directions, 4 polar nodes (two trapped, two escaping: Gauss rules on both sides of the critical
// cosine nu_c of a surface that looks along z) times azimuths of 22.5 and 67.5 degrees; the other octants are its
// mirror images. Weights sum to 1 over the sphere, so phi = sum_d w_d psi_d is the mean radiance, J = sum_d w_d Omega_d
// psi_d. Moments: sum w = 1, sum w Omega Omega^T = I / 3, half-range flux along z 1/4, all exact;
// that along x and y is 2.6 % off (two azimuths a quadrant), which is most of what orientation costs (docs/predict.md).
//
// Scattering is Henyey-Greenstein cut after its linear term, with a share f of it taken as not scattered: sigma_s* =
// sigma_s (1 - f), and the source in direction Omega is sigma_s* (phi + 3 g' Omega . J). Always (1 - f) (1 - g') =
// 1 - g: what is diffuse goes as far as it should. For g in [0, 1/2] f = g^2, g' = g / (1 + g) (delta-Eddington:
// Joseph, Wiscombe and Weinman 1976, J. Atmos. Sci. 33:2452). Beyond, g' is held at 1/3, for with more the source
// would be negative in some light; below 0 nothing is taken as not scattered, f = 0 and g' = g, down to -1/3, where g'
// is held again (f < 0 then: more is scattered, less backwards).
//
// The surface. A staircase of faces e stands for a smooth surface with outward normal n. Of the light of direction
// Omega that leaves through faces of the staircase, sum_e |n . e| (Omega . e)+ per true area, only Omega . n crosses
// the surface; the rest passes a corner of air and enters again through another step. So each face has for each
// direction
//   rho(Omega) = (Omega . n)+ / sum_e |n . e| (Omega . e)+       the share that meets the surface,
//   through = rho T(Omega . n),                                  what leaves for good,
//   mirror = min of rho (1 - T) of Omega and of what the mirror image has room for,
// and what is left over goes on as it was, to the faces near by that light of this direction enters: it is pooled in
// regions of 2 x 2 x 2 viewing cells, direction by direction; what a region has too much of one direction fills what it
// lacks of others, so that nothing is lost or made. Light comes in by reciprocity, along Omega with through(-Omega). T
// is smoothed over what a direction stands for and scaled by a factor of n so that isotropic light leaves the true
// surface with the exact diffuse transmittance (within 3 % for nine normals of ten, 9 % for the worst: the factor must
// not let more than everything through). A furnace stays at 1 for any normal; a flat face is a mirror.
#pragma once

#include <array>
#include <cstddef>

namespace voxtone::optics {

struct alignas(32) Octet {
    std::array<float, 8> v{};
};

struct DirectionSet {
    double g = 0, eta = 1;
    double forward_peak = 0;      ///< f
    double linear = 0;            ///< g'
    std::array<Octet, 3> cosine;  ///< along x, y, z, all positive
    Octet weight;                 ///< sum over the octant: 1/8
    std::array<double, 4> nu{}, nu_weight{},
        nu_transmittance{};            ///< the polar rule on (0, 1] and T at its nodes, matched
    double diffuse_transmittance = 1;  ///< share of isotropic light that leaves a flat face
};

/// g in (-1, 1), eta >= 1.
[[nodiscard]] DirectionSet make_directions(double g, double eta);

/// The same directions under a surface of another index, near that which they were made for.
[[nodiscard]] DirectionSet under_surface(DirectionSet set, double eta);

/// The 32 directions that leave through a face: [signs along the face][direction]; bit 0 of the signs is set where the
/// direction runs against the first of the two other axes, bit 1 against the second.
struct FaceLaw {
    std::array<Octet, 4> through, mirror;
    bool flat = true;  ///< nothing is left over
};

/// Nothing leaves.
[[nodiscard]] FaceLaw mirror_law();

/// The law of a face perpendicular to `axis` of a surface with this unit normal; its sign along the axis is the face's.
[[nodiscard]] FaceLaw face_law(const DirectionSet& set, int axis, const std::array<float, 3>& normal);

}  // namespace voxtone::optics

// SPDX-License-Identifier: GPL-3.0-or-later
//
// One light path through a volume of resins, in plain double precision: the definition that faster tracers must meet.
//
// By reciprocity the light that a surface cell sends out under uniform diffuse light is found by sending paths the
// other way: a path enters at a random point of the cell, from a direction of diffuse light that the refractive surface
// lets in (cosine-distributed in air, accepted with the Fresnel transmittance), is scattered (Henyey-Greenstein) and
// refracted, and counts its weight where it leaves into the light. The mean weight is the appearance: light that
// entered / light that would have entered is 1 for a body that absorbs nothing, path by path.
//
//   free path        exponential in optical depth, voxel by voxel
//   weight           times the albedo at every scattering; below `roulette_weight` the path survives with probability
//                    weight / roulette_weight and goes on with that weight: unbiased
//   bounces          no cap. Every 4096 meetings with the surface the path survives with probability 1/2 and twice its
//                    weight (unbiased), so that light trapped by total reflection in clear resin ends too
//   surface          reflected with the Fresnel reflectance, else it leaves. Light that left never comes back, but from
//                    a white sheet: there it enters again at the same place as diffuse light that is let in
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "voxtone/optics/appearance_model.h"
#include "voxtone/optics/path_random.h"

namespace voxtone::optics {

inline constexpr double default_roulette_weight = 0.1;

/// Where a path may start: the faces of a surface, drawn by area within a cell; where `smooth`, by the area of the
/// smooth surface that lies before a face.
class PathStarts {
public:
    PathStarts(const Scene& scene, const Surface& surface, bool smooth = false);
    /// Index of the face of `cell` where a number u in [0, 1) lands.
    [[nodiscard]] std::size_t face_at(const SurfaceCell& cell, double u) const;

private:
    std::vector<float> share_;  ///< per face: the running share of its cell's faces, by area; the last is 1
};

/// The direction in the resin of a ray of diffuse light that the surface lets in. Its normal lies along `axis`,
/// `inward` is 1 or -1.
[[nodiscard]] std::array<double, 3> entering_light(std::size_t axis, double inward, double eta, PathRandom& random);

/// All that a path needs to know; lives as long as the scene.
class PlainPaths {
public:
    explicit PlainPaths(const Scene& scene, double roulette_weight = default_roulette_weight);

    /// The weight of the path that these random numbers make, from this cell.
    [[nodiscard]] double weight(const Surface& surface, const PathStarts& starts, std::size_t cell, std::size_t channel,
                                PathRandom& random) const;

private:
    struct Optics {
        std::array<double, 256> sigma_t{}, albedo{};
    };
    void scatter(std::array<double, 3>& d, PathRandom& random) const;

    const ResinVolume& volume_;
    Backing backing_;
    Sides sides_;
    double eta_, g_, roulette_weight_;
    std::vector<Optics> channels_;
};

}  // namespace voxtone::optics

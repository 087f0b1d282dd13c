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
//   bounces          no cap. After 4096, 6144, 9216 ... meetings with the surface the path survives with probability
//                    1/2 and twice its weight (unbiased), so that light trapped by total reflection in clear resin ends
//                    too
//   surface          reflected with the Fresnel reflectance, else it leaves. Light that left never comes back, but from
//                    a white sheet: there it enters again at the same place as diffuse light that is let in
//   own index        of the resin whose voxel lies at the surface there. Within the body rays go straight from resin to
//                    resin (decisions/028). What is followed is radiance over the square of the index, which a change
//                    of index leaves as it is: a body that absorbs nothing stays 1
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "optics/monte_carlo/path_random.h"
#include "optics/monte_carlo/voxel_walk.h"
#include "optics/scene/appearance_model.h"

namespace voxtone::optics {

inline constexpr double default_roulette_weight = 0.1;

/// How many surfaces and mirrors a path may meet before Russian roulette with probability 1/2. The interval grows by
/// half each time: slower than the weight, so that the work for light that never comes out is bounded on average; fast
/// enough that the spread of the weights stays finite where it comes out late.
struct RouletteByOrder {
    std::uint32_t meetings = 0, allowed = 4096;
    /// False where the path ends. Exact on average.
    [[nodiscard]] bool survives(double& weight, PathRandom& random);
};

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

/// All that a path needs to know; lives as long as the scene. Voxels are sharp, whatever the set's dot spread.
class ScalarPaths {
public:
    explicit ScalarPaths(const Scene& scene, double roulette_weight = default_roulette_weight)
        : walk_(scene),
          backing_(scene.backing),
          sheet_(scene.sheet),
          pitch_mm_(scene.volume->pitch_mm()),
          surface_in_air_(reflectance_in_air(scene.resins->eta)),
          roulette_weight_(roulette_weight) {}

    /// The weight of the path that these random numbers make, from this cell.
    [[nodiscard]] double weight(const Surface& surface, const PathStarts& starts, std::size_t cell, std::size_t channel,
                                PathRandom& random) const;

private:
    VoxelWalk walk_;
    Backing backing_;
    std::shared_ptr<const Sheet> sheet_;
    std::array<double, 3> pitch_mm_;
    double surface_in_air_;
    double roulette_weight_;
};

/// Russian roulette below the roulette weight: false where the path ends.
[[nodiscard]] bool survives_roulette_by_weight(double& weight, double roulette_weight, PathRandom& random);

}  // namespace voxtone::optics

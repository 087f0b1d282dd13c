// SPDX-License-Identifier: GPL-3.0-or-later
//
// Light paths for the geometry of calibration: light from 45 degrees, seen from the normal, through the flat top of a
// volume; rho = pi L_o / E, mirror reflection left out (directional.h). Averaged over the azimuth of the light.
//
// A path starts down the normal (T_0 of it passes the surface) and is scattered as any other. At every scattering the
// beam of the light is asked how strongly it shines there: back along the refracted direction v to the top, through all
// resin on the way. With W the path's weight, nu = cos of the refracted 45 degrees, p the phase function per steradian,
// B the beam's flux per horizontal area,
//   rho = pi T_0 / (eta^2 nu) sum W p(v . d) B,      B = T_45 exp(-depth to the top) + what the surfaces send back,
// where the beam is reflected within the slab with the Fresnel reflectance R_45 at top and bottom. Where a path leaves
// downward on a sheet it sees T_45 B there, of which a share s (sheet.h) is sent back as diffuse light:
// rho += s T_0 W T_45 B / mean T.
// Unbiased; light from below does not exist in this geometry. Resins of indices of their own: a path keeps to that of
// the resin where it went in.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "optics/monte_carlo/scalar_paths.h"

namespace voxtone::optics {

class DirectionalPaths {
public:
    explicit DirectionalPaths(const Scene& scene, double roulette_weight = default_roulette_weight);

    /// An estimate of rho from one path; the mean over paths is rho.
    [[nodiscard]] double estimate(const Surface& surface, const PathStarts& starts, std::size_t cell,
                                  std::size_t channel, PathRandom& random) const;

private:
    /// What the surface of a material does to this light: as above.
    struct Skin {
        double eta = 1, nu = 1, sine = 0, R_45 = 0, T_0 = 1, mean_T = 1;
    };
    [[nodiscard]] double sent_back(const Ray& ray, const Skin& skin, std::size_t channel) const;
    [[nodiscard]] double beam(Ray ray, const Skin& skin, const VoxelWalk::Optics& optics, PathRandom& random) const;

    VoxelWalk walk_;
    Backing backing_;
    std::shared_ptr<const Sheet> sheet_;
    std::array<double, 2> pitch_mm_;
    double roulette_weight_;
    std::vector<Skin> skins_;  ///< per material
};

}  // namespace voxtone::optics

// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/monte_carlo/directional_paths.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "optics/numerics/quadrature.h"
#include "optics/scene/fresnel.h"

namespace voxtone::optics {
namespace {

using std::numbers::pi;
// The transmittance of the way to the light is exact up to this optical depth and by chance beyond: who asks from the
// depth seldom has to go all the way.
constexpr double exact_depth = 1;

double henyey_greenstein(double cosine, double g) {
    const double q = 1 + g * g - 2 * g * cosine;
    return (1 - g * g) / (4 * pi * q * std::sqrt(q));
}

/// Share of diffuse light that the surface lets in.
double mean_transmittance(double eta) {
    const Rule cosine = gauss_legendre(32, 0, 1);
    double sum = 0;
    for (std::size_t k = 0; k < cosine.x.size(); ++k)
        sum += 2 * cosine.x[k] * cosine.w[k] * (1 - fresnel_reflectance(cosine.x[k], eta));
    return sum;
}

}  // namespace

DirectionalPaths::DirectionalPaths(const Scene& scene, double roulette_weight)
    : walk_(scene),
      backing_(scene.backing),
      sheet_(scene.sheet),
      pitch_mm_{scene.volume->pitch_mm()[0], scene.volume->pitch_mm()[1]},
      roulette_weight_(roulette_weight),
      skins_(scene.resins->resins.size() + 1) {
    for (std::size_t m = 0; m < skins_.size(); ++m) {
        Skin& skin = skins_[m];
        skin.eta = walk_.eta(static_cast<Material>(m));
        skin.nu = cosine_in_resin(std::numbers::sqrt2 / 2, skin.eta);
        skin.sine = std::sqrt(1 - skin.nu * skin.nu);
        skin.R_45 = fresnel_reflectance(std::numbers::sqrt2 / 2, skin.eta);
        skin.T_0 = 1 - fresnel_reflectance(1, skin.eta);
        skin.mean_T = mean_transmittance(skin.eta);
    }
}

/// Of light that leaves on what lies below.
double DirectionalPaths::sent_back(const Ray& ray, const Skin& skin, std::size_t channel) const {
    if (backing_ != Backing::sheet) return backing_ == Backing::white ? 1 : 0;
    return share_sent_back(static_cast<double>(sheet_->at(ray.voxel[0] * pitch_mm_[0] + ray.at[0],
                                                          ray.voxel[1] * pitch_mm_[1] + ray.at[1], channel)),
                           1 - skin.mean_T);
}

/// B where the ray is, for light that comes along -ray.d.
double DirectionalPaths::beam(Ray ray, const Skin& skin, const VoxelWalk::Optics& optics, PathRandom& random) const {
    double sum = 0, transmittance = 1;
    std::uint32_t meetings = 0;
    bool certain = ray.d[2] < 0;  // who asks downward asks for the reflection
    if (certain) transmittance = skin.R_45;
    for (;;) {
        const double most = exact_depth - std::log1p(-random.uniform());
        double depth = most;
        if (!walk_.advance(ray, optics, depth, meetings).at_surface) return sum;
        transmittance *= std::exp(-std::min(exact_depth, most - depth));
        if (ray.d[2] > 0) sum += transmittance * (1 - skin.R_45);
        if (!certain && random.uniform() >= skin.R_45) return sum;
        certain = false;
        ray.d[2] = -ray.d[2];
    }
}

double DirectionalPaths::estimate(const Surface& surface, const PathStarts& starts, std::size_t cell,
                                  std::size_t channel, PathRandom& random) const {
    const VoxelWalk::Optics& optics = walk_.optics(channel);
    const SurfaceFace& face = surface.faces[starts.face_at(surface.cells[cell], random.uniform())];
    const double u = random.uniform(), v = random.uniform();
    Ray ray = walk_.at_face(face, u, v);
    ray.d = {0, 0, -1};
    const Skin& skin = skins_[ray.material];

    const auto ray_from = [&](double z) {
        Ray to_light = ray;
        const double phi = 2 * pi * random.uniform();
        to_light.d = {skin.sine * std::cos(phi), skin.sine * std::sin(phi), z};
        return to_light;
    };
    double sum = 0, weight = 1;
    RouletteByOrder patience;
    for (;;) {
        double depth = -std::log1p(-random.uniform());
        for (;;) {
            const Stop stop = walk_.advance(ray, optics, depth, patience.meetings);
            if (!patience.survives(weight, random)) return sum;
            if (!stop.at_surface) break;
            if (random.uniform() < internal_reflectance(std::abs(ray.d[stop.axis]), skin.eta)) {
                ray.d[stop.axis] = -ray.d[stop.axis];
                continue;
            }
            if (stop.on_sheet) weight *= sent_back(ray, skin, channel);
            if (!stop.on_sheet || weight <= 0) return sum;
            sum += skin.T_0 * weight * (1 - skin.R_45) * beam(ray_from(skin.nu), skin, optics, random) / skin.mean_T;
            ray.d = entering_light(2, 1.0, skin.eta, random);
        }
        weight *= optics.albedo[ray.material];
        if (!survives_roulette_by_weight(weight, roulette_weight_, random)) return sum;
        // Downward, as rarely as it is faint, for the light that the lower surface reflected.
        const bool down = random.uniform() < skin.R_45;
        const Ray to_light = ray_from(down ? -skin.nu : skin.nu);
        const double cosine = ray.d[0] * to_light.d[0] + ray.d[1] * to_light.d[1] + ray.d[2] * to_light.d[2];
        const double B = beam(to_light, skin, optics, random);
        sum += pi * skin.T_0 / (skin.eta * skin.eta * skin.nu) * weight *
               henyey_greenstein(cosine, walk_.g(ray.material)) * B / (down ? skin.R_45 : 1 - skin.R_45);
        walk_.scatter(ray, random);
    }
}

}  // namespace voxtone::optics

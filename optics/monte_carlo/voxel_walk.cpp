// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/monte_carlo/voxel_walk.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "optics/scene/fresnel.h"

namespace voxtone::optics {

double internal_reflectance(double nu, double eta) {
    const double mu2 = 1 - eta * eta * (1 - nu * nu);
    return mu2 <= 0 ? 1.0 : fresnel_reflectance(std::sqrt(mu2), eta);
}

std::array<double, 3> entering_light(std::size_t axis, double inward, double eta, PathRandom& random) {
    double mu = 0;
    do mu = std::sqrt(random.uniform());
    while (random.uniform() < fresnel_reflectance(mu, eta));
    const double nu = cosine_in_resin(mu, eta), sine = std::sqrt(1 - nu * nu);
    const double phi = 2 * std::numbers::pi * random.uniform();
    std::array<double, 3> d{};
    d[axis] = inward * nu;
    d[(axis + 1) % 3] = sine * std::cos(phi);
    d[(axis + 2) % 3] = sine * std::sin(phi);
    return d;
}

VoxelWalk::VoxelWalk(const Scene& scene)
    : volume_(*scene.volume), sides_(scene.sides), channels_(scene.resins->channels.size()) {
    eta_.fill(scene.resins->eta), g_.fill(scene.resins->g);
    for (std::size_t r = 0; r < scene.resins->resins.size() && r < 255; ++r) {
        eta_[r + 1] = scene.resins->eta_of(scene.resins->resins[r]);
        g_[r + 1] = scene.resins->g_of(scene.resins->resins[r]);
    }
    for (std::size_t c = 0; c < channels_.size(); ++c)
        for (std::size_t r = 0; r < scene.resins->resins.size() && r < 255; ++r) {
            const Medium medium = scene.resins->resins[r].own_medium(c);
            channels_[c].sigma_t[r + 1] = medium.sigma_t();
            channels_[c].albedo[r + 1] = medium.albedo();
        }
}

Ray VoxelWalk::at_face(const SurfaceFace& face, double u, double v) const {
    const auto& pitch = volume_.pitch_mm();
    Ray ray;
    ray.voxel = {face.voxel[0], face.voxel[1], face.voxel[2]};
    const auto axis = static_cast<std::size_t>(face.facing) / 2, along_u = (axis + 1) % 3, along_v = (axis + 2) % 3;
    ray.at[axis] = static_cast<int>(face.facing) % 2 == 1 ? pitch[axis] : 0.0;
    ray.at[along_u] = pitch[along_u] * u;
    ray.at[along_v] = pitch[along_v] * v;
    ray.material = volume_.at(ray.voxel[0], ray.voxel[1], ray.voxel[2]);
    return ray;
}

Stop VoxelWalk::advance(Ray& ray, const Optics& optics, double& depth, std::uint32_t& meetings) const {
    const auto& pitch = volume_.pitch_mm();
    auto& [voxel, at, d, material] = ray;
    for (;;) {
        double step = 1e300;
        std::size_t axis = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            if (d[a] == 0) continue;
            const double to_side = ((d[a] > 0 ? pitch[a] : 0.0) - at[a]) / d[a];
            if (to_side < step) {
                step = to_side;
                axis = a;
            }
        }
        const double sigma_t = optics.sigma_t[material];
        if (depth < sigma_t * step) {
            for (std::size_t a = 0; a < 3; ++a) at[a] = std::clamp(at[a] + d[a] * (depth / sigma_t), 0.0, pitch[a]);
            depth = 0;
            return {};
        }
        depth -= sigma_t * step;
        const bool forward = d[axis] > 0;
        for (std::size_t a = 0; a < 3; ++a) at[a] = std::clamp(at[a] + d[a] * step, 0.0, pitch[a]);
        at[axis] = forward ? pitch[axis] : 0.0;

        std::array<int, 3> next = voxel;
        next[axis] += forward ? 1 : -1;
        if (sides_ == Sides::mirrored && axis < 2 && (next[axis] < 0 || next[axis] >= volume_.size()[axis])) {
            ++meetings;
            d[axis] = -d[axis];
            continue;
        }
        const Material beyond = volume_.at(next[0], next[1], next[2]);
        if (beyond == air) {
            ++meetings;
            return {true, axis, axis == 2 && next[2] < 0};
        }
        voxel = next;
        material = beyond;
        at[axis] = forward ? 0.0 : pitch[axis];
    }
}

void turn_henyey_greenstein(std::array<double, 3>& d, double g, PathRandom& random) {
    const double u = random.uniform();
    // The inverse of Henyey and Greenstein's distribution, free of cancellation and of a special case for g = 0.
    const double D = 1 - g + 2 * g * u, versine = 2 * (1 - g) * (1 - g) * (1 - u) * (1 + g * u) / (D * D);
    const double cosine = 1 - versine, sine = std::sqrt(std::max(0.0, versine * (2 - versine))),
                 phi = 2 * std::numbers::pi * random.uniform();
    const double a = sine * std::cos(phi), b = sine * std::sin(phi);
    // Two directions across d (Duff et al. 2017, "Building an orthonormal basis, revisited").
    const double s = std::copysign(1.0, d[2]), k = -1 / (s + d[2]), m = d[0] * d[1] * k;
    const std::array<double, 3> e{1 + s * d[0] * d[0] * k, s * m, -s * d[0]}, f{m, s + d[1] * d[1] * k, -d[1]};
    for (std::size_t i = 0; i < 3; ++i) d[i] = cosine * d[i] + a * e[i] + b * f[i];
    const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    for (double& x : d) x /= length;
}

}  // namespace voxtone::optics

// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/optics/plain_paths.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "voxtone/base/contracts.h"
#include "voxtone/optics/fresnel.h"

namespace voxtone::optics {
namespace {

constexpr std::uint32_t meetings_before_roulette = 4096;

/// Share of the flux reflected for a ray in the resin with cosine nu to the normal.
double internal_reflectance(double nu, double eta) {
    const double mu2 = 1 - eta * eta * (1 - nu * nu);
    return mu2 <= 0 ? 1.0 : fresnel_reflectance(std::sqrt(mu2), eta);
}

double face_area(std::size_t axis, const std::array<double, 3>& pitch) {
    return pitch[(axis + 1) % 3] * pitch[(axis + 2) % 3];
}

}  // namespace

PathStarts::PathStarts(const Scene& scene, const Surface& surface, bool smooth) : share_(surface.faces.size()) {
    const auto& pitch = scene.volume->pitch_mm();
    for (const SurfaceCell& cell : surface.cells) {
        VOXTONE_EXPECT(cell.faces > 0 && cell.first_face + cell.faces <= surface.faces.size());
        double total = 0, sum = 0;
        const auto area = [&](std::uint32_t f) {
            const std::uint32_t face = cell.first_face + f;
            const auto axis = static_cast<std::size_t>(surface.faces[face].facing) / 2;
            return face_area(axis, pitch) *
                   (smooth ? std::max(1e-6, std::abs(static_cast<double>(surface.face_normal[face][axis]))) : 1.0);
        };
        for (std::uint32_t f = 0; f < cell.faces; ++f) total += area(f);
        for (std::uint32_t f = 0; f < cell.faces; ++f) {
            sum += area(f);
            share_[cell.first_face + f] = f + 1 == cell.faces ? 1.0f : static_cast<float>(sum / total);
        }
    }
}

std::size_t PathStarts::face_at(const SurfaceCell& cell, double u) const {
    const auto first = share_.begin() + cell.first_face;
    return static_cast<std::size_t>(std::upper_bound(first, first + cell.faces - 1, u) - share_.begin());
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

PlainPaths::PlainPaths(const Scene& scene, double roulette_weight)
    : volume_(*scene.volume),
      backing_(scene.backing),
      sides_(scene.sides),
      eta_(scene.resins->eta),
      g_(scene.resins->g),
      roulette_weight_(roulette_weight),
      channels_(scene.resins->channels.size()) {
    for (std::size_t c = 0; c < channels_.size(); ++c)
        for (std::size_t r = 0; r < scene.resins->resins.size(); ++r) {
            const Medium medium = scene.resins->resins[r].medium(c);
            channels_[c].sigma_t[r + 1] = medium.sigma_t();
            channels_[c].albedo[r + 1] = medium.albedo();
        }
}

void PlainPaths::scatter(std::array<double, 3>& d, PathRandom& random) const {
    const double u = random.uniform();
    // The inverse of Henyey and Greenstein's distribution, free of cancellation and of a special case for g = 0.
    const double D = 1 - g_ + 2 * g_ * u, versine = 2 * (1 - g_) * (1 - g_) * (1 - u) * (1 + g_ * u) / (D * D);
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

double PlainPaths::weight(const Surface& surface, const PathStarts& starts, std::size_t cell, std::size_t channel,
                          PathRandom& random) const {
    const Optics& optics = channels_[channel];
    const auto& pitch = volume_.pitch_mm();
    const SurfaceFace& face = surface.faces[starts.face_at(surface.cells[cell], random.uniform())];

    // Place within the voxel in mm, 0 .. pitch: exact at the voxel's sides.
    std::array<int, 3> voxel{face.voxel[0], face.voxel[1], face.voxel[2]};
    std::array<double, 3> at{};
    const auto first_axis = static_cast<std::size_t>(face.facing) / 2;
    const bool looks_up = static_cast<int>(face.facing) % 2 == 1;
    at[first_axis] = looks_up ? pitch[first_axis] : 0.0;
    for (const std::size_t a : {(first_axis + 1) % 3, (first_axis + 2) % 3}) at[a] = pitch[a] * random.uniform();
    std::array<double, 3> d = entering_light(first_axis, looks_up ? -1.0 : 1.0, eta_, random);

    Material material = volume_.at(voxel[0], voxel[1], voxel[2]);
    double weight = 1;
    std::uint32_t meetings = 0;
    for (;;) {
        double depth = -std::log1p(-random.uniform());
        for (;;) {  // from voxel to voxel until the optical depth is used up
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
                break;
            }
            depth -= sigma_t * step;
            const bool forward = d[axis] > 0;
            for (std::size_t a = 0; a < 3; ++a) at[a] = std::clamp(at[a] + d[a] * step, 0.0, pitch[a]);
            at[axis] = forward ? pitch[axis] : 0.0;

            std::array<int, 3> next = voxel;
            next[axis] += forward ? 1 : -1;
            if (sides_ == Sides::mirrored && axis < 2 && (next[axis] < 0 || next[axis] >= volume_.size()[axis])) {
                d[axis] = -d[axis];
                continue;
            }
            const Material beyond = volume_.at(next[0], next[1], next[2]);
            if (beyond != air) {
                voxel = next;
                material = beyond;
                at[axis] = forward ? 0.0 : pitch[axis];
                continue;
            }
            if (++meetings % meetings_before_roulette == 0) {
                if (random.uniform() < 0.5) return 0;
                weight *= 2;
            }
            if (random.uniform() < internal_reflectance(std::abs(d[axis]), eta_)) {
                d[axis] = -d[axis];
                continue;
            }
            const bool on_sheet = axis == 2 && next[2] < 0;
            if (!on_sheet || backing_ == Backing::none) return weight;
            if (backing_ == Backing::black) return 0;
            d = entering_light(2, 1.0, eta_, random);
        }
        weight *= optics.albedo[material];
        if (weight < roulette_weight_) {
            if (random.uniform() * roulette_weight_ >= weight) return 0;
            weight = roulette_weight_;
        }
        scatter(d, random);
    }
}

}  // namespace voxtone::optics

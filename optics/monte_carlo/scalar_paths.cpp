// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/monte_carlo/scalar_paths.h"

#include <algorithm>
#include <cmath>

#include "base/contracts.h"

namespace voxtone::optics {
namespace {

double face_area(std::size_t axis, const std::array<double, 3>& pitch) {
    return pitch[(axis + 1) % 3] * pitch[(axis + 2) % 3];
}

}  // namespace

PathStarts::PathStarts(const Scene& scene, const Surface& surface, bool smooth) : share_(surface.faces.size()) {
    const auto& pitch = scene.volume->pitch_mm();
    for (std::size_t c = 0; c < surface.cells.size(); ++c) {
        const SurfaceCell& cell = surface.cells[c];
        VOXTONE_EXPECT(cell.faces > 0 && cell.first_face + cell.faces <= surface.faces.size());
        double total = 0, sum = 0;
        const auto area = [&](std::uint32_t f) {
            const std::uint32_t face = cell.first_face + f;
            const auto axis = static_cast<std::size_t>(surface.faces[face].facing) / 2;
            return face_area(axis, pitch) *
                   (smooth ? std::max(1e-6, std::abs(static_cast<double>(surface.normal_at(c, face)[axis]))) : 1.0);
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

bool RouletteByOrder::survives(double& weight, PathRandom& random) {
    if (meetings < allowed) return true;
    allowed += allowed / 2;
    weight *= 2;
    return random.uniform() < 0.5;
}

bool survives_roulette_by_weight(double& weight, double roulette_weight, PathRandom& random) {
    if (weight >= roulette_weight) return true;
    if (random.uniform() * roulette_weight >= weight) return false;
    weight = roulette_weight;
    return true;
}

double ScalarPaths::weight(const Surface& surface, const PathStarts& starts, std::size_t cell, std::size_t channel,
                           PathRandom& random) const {
    const VoxelWalk::Optics& optics = walk_.optics(channel);
    const SurfaceFace& face = surface.faces[starts.face_at(surface.cells[cell], random.uniform())];
    const double u = random.uniform(), v = random.uniform();
    Ray ray = walk_.at_face(face, u, v);
    const int facing = static_cast<int>(face.facing);
    ray.d = entering_light(static_cast<std::size_t>(facing / 2), facing % 2 == 1 ? -1.0 : 1.0, walk_.eta(ray.material),
                           random);

    double weight = 1;
    RouletteByOrder patience;
    for (;;) {
        double depth = -std::log1p(-random.uniform());
        for (;;) {
            const Stop stop = walk_.advance(ray, optics, depth, patience.meetings);
            if (!patience.survives(weight, random)) return 0;
            if (!stop.at_surface) break;
            if (random.uniform() < internal_reflectance(std::abs(ray.d[stop.axis]), walk_.eta(ray.material))) {
                ray.d[stop.axis] = -ray.d[stop.axis];
                continue;
            }
            if (!stop.on_sheet || backing_ == Backing::none) return weight;
            if (backing_ == Backing::black) return 0;
            if (backing_ == Backing::sheet)
                weight *= share_sent_back(sheet_->at(ray.voxel[0] * pitch_mm_[0] + ray.at[0],
                                                     ray.voxel[1] * pitch_mm_[1] + ray.at[1], channel),
                                          surface_in_air_);
            if (weight <= 0) return 0;
            ray.d = entering_light(2, 1.0, walk_.eta(air), random);
        }
        weight *= optics.albedo[ray.material];
        if (!survives_roulette_by_weight(weight, roulette_weight_, random)) return 0;
        walk_.scatter(ray, random);
    }
}

}  // namespace voxtone::optics

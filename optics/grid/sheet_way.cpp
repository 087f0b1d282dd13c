// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/grid/sheet_way.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace voxtone::optics {
namespace {

struct DiffuseLight {
    double D_mm, decay_per_mm;
};
DiffuseLight diffuse_light(const Medium& medium, double g) {
    constexpr double least = 1e-9;
    const double D = 1 / (3 * std::max(medium.sigma_a + (1 - g) * medium.sigma_s, least));
    return {D, std::sqrt(std::max(medium.sigma_a, least) / D)};
}

/// Share of the light from everywhere that a sheet takes through a slab of thickness d.
double taken(const DiffuseLight& in, double d, double way, double first_way) {
    const double k = in.D_mm * in.decay_per_mm, t = std::tanh(in.decay_per_mm * d);
    const double admittance = k * (1 / way + k * t) / (k + t / way);
    return 4 / (first_way + 1 / admittance);
}

/// T and U of the header.
std::array<double, 2> let_out(const DirectionSet& set) {
    const FaceLaw law = face_law(set, 2, {0, 0, 1});
    std::array<double, 2> all{}, through{};  // of phi and of J
    for (std::size_t d = 0; d < 8; ++d) {
        const auto cosine = static_cast<double>(set.cosine[2].v[d]);
        double weight = static_cast<double>(set.weight.v[d]) * cosine;
        for (std::size_t of = 0; of < 2; ++of, weight *= cosine) {
            all[of] += weight;
            through[of] += weight * static_cast<double>(law.through[0].v[d]);
        }
    }
    return {through[0] / all[0], through[1] / all[1]};
}

}  // namespace

double let_out_of_diffuse(const DirectionSet& set) { return let_out(set)[0]; }

double way_into_sheet(const DirectionSet& set) {
    const auto [T, U] = let_out(set);
    constexpr double unmirrored = 1.066, mirrored = 0.95, T_mirrored = 0.404;
    return (mirrored + (unmirrored - mirrored) * (T - T_mirrored) / (1 - T_mirrored)) * (4 - 2 * U) / T;
}

double sheet_depth_mm(const ResinSet& set, const Resin& resin, const DirectionSet& directions) {
    constexpr double step = 0.05, most = 50, never = 1e6, too_long = 1.1, allowed = 0.001;
    const double way = way_into_sheet(directions);
    double depth = 0;
    for (std::size_t c = 0; c < set.channels.size(); ++c) {
        const DiffuseLight in = diffuse_light(resin.medium(c), set.g);
        while (depth < most && taken(in, depth, way, way) - taken(in, depth, too_long * way, way) > allowed)
            depth += step;
    }
    return depth < most ? depth : never;
}

}  // namespace voxtone::optics

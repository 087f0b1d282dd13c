// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/asked_alpha.h"

#include <algorithm>

#include <fmt/core.h>

#include "base/warning.h"
#include "slicer/surface/area_samples.h"

namespace voxtone::slicer {

std::string alpha_out_of_reach(const VisibleSurface& surface, const SurfaceColour& colour,
                               const halftone::Translucency& translucency) {
    if (surface.triangles.empty()) return {};
    // What an eye may tell, and what of eight bits is meant as 1.
    constexpr double seen = 0.05, as_one = 0.99;
    constexpr std::uint64_t samples = 10'000;
    const AreaSamples points(surface);
    std::uint64_t beyond = 0;
    double asked = 0, shown = 1;
    for (std::uint64_t i = 0; i < samples; ++i) {
        const auto [t, u, v] = points.at(1, i);
        const Eigen::Vector2f uv = float(1 - u - v) * surface.source_uv[t][0] + float(u) * surface.source_uv[t][1] +
                                   float(v) * surface.source_uv[t][2];
        const double alpha = colour.alpha_at(surface.source_triangle[t], uv.x(), uv.y());
        if (alpha >= as_one) continue;
        const double most = translucency.most_alpha(colour.at(surface.source_triangle[t], uv.x(), uv.y()));
        if (alpha < most + seen) continue;
        ++beyond;
        asked = std::max(asked, alpha), shown = std::min(shown, most);
    }
    if (beyond < samples / 100) return {};
    return named_warning(
        "alpha-range",
        fmt::format(
            "{:.0f} % of the surface asks for a translucency alpha of up to {:.2f} where the resins show {:.2f} "
            "at the most, however thick: it is printed as 1 is, without clear resin",
            100 * double(beyond) / samples, asked, shown));
}

}  // namespace voxtone::slicer

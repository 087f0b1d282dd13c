// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/asked_alpha.h"

#include <algorithm>

#include <fmt/core.h>

#include "base/warning.h"
#include "optics/colour/colour.h"
#include "slicer/surface/area_samples.h"
#include "slicer/surface/target_cells.h"

namespace voxtone::slicer {

namespace {

// What an eye may tell, and what of eight bits is meant as 1.
constexpr double told = 0.05;
constexpr float as_one = 0.99f;

Eigen::Vector3f grey_of_alpha(float alpha) {
    return Eigen::Vector3f::Constant(float(optics::srgb_decode(double(std::clamp(alpha, 0.0f, 1.0f)))));
}

Eigen::Vector3f colour_of_loss(float alpha) {
    constexpr double of_one = 40;  // CIEDE2000 whose colour in maps of differences it has
    return difference_colour(of_one * double(alpha));
}

}  // namespace

const std::array<AlphaMap, 3>& alpha_maps() {
    static constexpr std::array<AlphaMap, 3> maps{
        {{"alpha asked", "alpha asked for: black 0, clear, to white 1, opaque", grey_of_alpha},
         {"alpha shown", "alpha that the resins show, by the separation's own model of a wide slab", grey_of_alpha},
         {"alpha given up", "alpha given up: white 0, yellow 0.05, orange 0.13, red 0.25, black 0.5", colour_of_loss}}};
    return maps;
}

Eigen::Vector3f PrintedAlpha::at(std::uint32_t triangle, float u, float v) const {
    const Eigen::Vector3f rgb = colour_.at(triangle, u, v);
    const float asked = colour_.alpha_at(triangle, u, v),
                shown = float(translucency_.shown_alpha(rgb, translucency_.kept(rgb, asked)));
    return {asked, shown, asked < as_one ? std::max(asked - shown, 0.0f) : 0};
}

PrintedAlpha::Samples PrintedAlpha::samples() const {
    Samples out;
    if (surface_.triangles.empty()) return out;
    constexpr int count = 10'000;
    const AreaSamples points(surface_);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int beyond = 0;
    for (int i = 0; i < count; ++i) {
        const auto [t, u, v] = points.at(1, std::uint64_t(i));
        const Eigen::Vector2f uv = float(1 - u - v) * surface_.source_uv[t][0] + float(u) * surface_.source_uv[t][1] +
                                   float(v) * surface_.source_uv[t][2];
        const Eigen::Vector3d alpha = at(surface_.source_triangle[t], uv.x(), uv.y()).cast<double>();
        sum += alpha;
        out.figures.given_up_max = std::max(out.figures.given_up_max, alpha[2]);
        if (alpha[2] < told) continue;
        ++beyond;
        out.most_asked = std::max(out.most_asked, alpha[0]), out.least_shown = std::min(out.least_shown, alpha[1]);
    }
    out.figures.asked_mean = sum[0] / count, out.figures.shown_mean = sum[1] / count;
    out.figures.given_up_mean = sum[2] / count, out.figures.given_up_share = double(beyond) / count;
    return out;
}

io::ReportTranslucency PrintedAlpha::figures() const { return samples().figures; }

std::string PrintedAlpha::warning() const {
    const Samples found = samples();
    if (found.figures.given_up_share < 0.01) return {};
    return named_warning(
        "alpha-range",
        fmt::format(
            "{:.0f} % of the surface asks for a translucency alpha of up to {:.2f} where the resins show {:.2f} "
            "at the most, however thick: it is printed as 1 is, without clear resin",
            100 * found.figures.given_up_share, found.most_asked, found.least_shown));
}

std::vector<ColouredSurface> PrintedAlpha::maps() const {
    std::vector<ColouredSurface> out;
    for (Eigen::Index map = 0; map < 3; ++map) {
        ColouredSurface& surface = out.emplace_back();
        surface.positions_mm = surface_.positions_mm;
        surface.triangles = surface_.triangles;
        surface.colour = [*this, map](std::uint32_t t, float u, float v) {
            const auto& corner = surface_.source_uv[t];
            const Eigen::Vector2f uv = (1 - u - v) * corner[0] + u * corner[1] + v * corner[2];
            return alpha_maps()[std::size_t(map)].colour(at(surface_.source_triangle[t], uv.x(), uv.y())[map]);
        };
    }
    return out;
}

std::vector<std::vector<Eigen::Vector3f>> alpha_of_cells(const optics::Surface& cells,
                                                         const std::array<double, 3>& pitch_mm, const JobBody& body,
                                                         const halftone::Translucency& translucency) {
    const SurfaceColour colour(body.model.mesh, sample_spacing_mm(cells, pitch_mm));
    const PrintedAlpha alpha(*body.surface, colour, translucency);
    const std::vector<Eigen::Vector3f> mean = mean_of_cells(
        cells, pitch_mm, body.grid.origin_mm, body.surface,
        [&alpha](std::uint32_t triangle, float u, float v) { return alpha.at(triangle, u, v); }, nullptr);
    std::vector<std::vector<Eigen::Vector3f>> out(3);
    for (Eigen::Index map = 0; map < 3; ++map)
        for (const Eigen::Vector3f& value : mean)
            out[std::size_t(map)].push_back(alpha_maps()[std::size_t(map)].colour(value[map]));
    return out;
}

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/lost_texture.h"

#include <algorithm>
#include <cmath>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/colour/colour.h"

namespace voxtone::slicer {

namespace {

using CellColours = std::vector<Eigen::Vector3f>;

constexpr double mean_by = 2, pool_by = 4;  // of the narrowest Gaussian
constexpr float flat_ground = 0.25f;

halftone::EyeFilter gaussian(const optics::Surface& surface, double distance_mm) {
    return {surface, distance_mm, halftone::EyeSurround::none, halftone::OpponentSpace::cielab,
            halftone::EyeParts::narrowest};
}

float lightness_of(const Eigen::Vector3f& rgb) {
    return static_cast<float>(optics::oklab_from_linear_srgb(rgb.cast<double>().cwiseMax(0))[0]);
}

/// Per cell how much of what lies around it is of flat regions.
CellColours flat_around(const halftone::EyeFilter& wide, std::span<const halftone::ColourRegion> regions,
                        std::size_t cells) {
    CellColours flat(cells, Eigen::Vector3f::Zero());
    for (const halftone::ColourRegion& region : regions)
        for (const std::uint32_t i : region.cells) flat[i].setOnes();
    return wide.smoothed(flat);
}

}  // namespace

std::vector<TextureLook> look_at_texture(const optics::Surface& surface, std::span<const Eigen::Vector3f> near_target,
                                         std::span<const Eigen::Vector3f> near,
                                         std::span<const halftone::ColourRegion> regions,
                                         const halftone::EyeFilter& wide, double viewing_distance_mm) {
    VOXTONE_EXPECT(near.size() == near_target.size() && near.size() == surface.cells.size());
    const std::size_t n = near.size();
    const halftone::EyeFilter pool = gaussian(surface, pool_by * viewing_distance_mm);
    CellColours light(n);
    parallel_for(0, n, 1024, [&](std::size_t i) {
        light[i] = {lightness_of(near_target[i]), lightness_of(near[i]), 0};
    });
    const CellColours mean = gaussian(surface, mean_by * viewing_distance_mm).smoothed(light);
    parallel_for(0, n, 1024, [&](std::size_t i) {
        const float t = light[i][0] - mean[i][0], p = light[i][1] - mean[i][1];
        light[i] = {t * t, t * p, 0};
    });
    const CellColours product = pool.smoothed(light), flat = flat_around(wide, regions, n);
    std::vector<TextureLook> looks(n);
    parallel_for(0, n, 1024, [&](std::size_t i) {
        if (flat[i][0] <= flat_ground && product[i][0] > 0)
            looks[i] = {std::sqrt(product[i][0]), std::max(0.0f, product[i][1] / product[i][0])};
    });
    return looks;
}

std::optional<LostTexture> lost_texture(const optics::Surface& surface, std::span<const TextureLook> texture,
                                        std::span<const double> seen) {
    constexpr double least_share = 0.02;
    VOXTONE_EXPECT(texture.size() == surface.cells.size() && seen.size() == texture.size());
    LostTexture lost;
    double all_seen = 0, asked = 0, kept = 0;
    for (std::size_t i = 0; i < texture.size(); ++i) {
        all_seen += seen[i];
        if (!texture[i].is_lost()) continue;
        const double area = surface.cells[i].area_mm2, square = area * double(texture[i].asked) * texture[i].asked;
        lost.cells.push_back(static_cast<std::uint32_t>(i));
        lost.area_mm2 += area, lost.seen_share += seen[i];
        asked += square, kept += square * double(texture[i].kept);
    }
    if (lost.cells.empty() || lost.seen_share < least_share * all_seen) return std::nullopt;
    lost.seen_share /= all_seen;
    lost.kept = kept / asked;
    return lost;
}

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/evenness.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "optics/colour/colour.h"

namespace voxtone::slicer {

namespace {

Eigen::Vector3d lab_of(const Eigen::Vector3f& rgb) {
    return optics::lab_from_linear_srgb(rgb.cast<double>().cwiseMax(0));
}

using Values = std::vector<Eigen::Vector3d>;

/// Places in a region's cells of those of it that touch each one, itself too.
std::vector<std::vector<std::uint32_t>> touching(const halftone::ColourRegion& region,
                                                 const halftone::CellNeighbours& cells) {
    const std::vector<std::uint32_t>& own = region.cells;
    std::vector<std::vector<std::uint32_t>> near(own.size());
    parallel_for(0, own.size(), 1024, [&](std::size_t n) {
        cells.visit_around(own[n], [&](std::size_t other) {
            const auto at = std::ranges::lower_bound(own, static_cast<std::uint32_t>(other));
            if (at != own.end() && *at == other) near[n].push_back(static_cast<std::uint32_t>(at - own.begin()));
        });
    });
    return near;
}

Values means_around(const std::vector<std::vector<std::uint32_t>>& near, const Values& values) {
    Values means(values.size());
    parallel_for(0, values.size(), 1024, [&](std::size_t n) {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (const std::uint32_t other : near[n]) sum += values[other];
        means[n] = sum / double(near[n].size());
    });
    return means;
}

}  // namespace

double unevenness_of(const halftone::ColourRegion& region, const halftone::CellNeighbours& cells,
                     std::span<const Eigen::Vector3f> target, std::span<const Eigen::Vector3f> print) {
    constexpr int rounds = 8;
    Values off(region.cells.size());
    parallel_for(0, off.size(), 1024,
                 [&](std::size_t n) { off[n] = lab_of(print[region.cells[n]]) - lab_of(target[region.cells[n]]); });
    const auto near = touching(region, cells);
    Values slow = off;
    for (int round = 0; round < rounds; ++round) slow = means_around(near, slow);
    const optics::Surface& surface = cells.surface();
    Eigen::Vector3d printed = Eigen::Vector3d::Zero();
    double area = 0, squares = 0;
    for (const std::uint32_t i : region.interior) {
        const double a = surface.cells[i].area_mm2;
        area += a, printed += a * lab_of(print[i]);
    }
    if (!(area > 0)) return 0;
    printed /= area;
    for (const std::uint32_t i : region.interior) {
        const auto n = static_cast<std::size_t>(std::ranges::lower_bound(region.cells, i) - region.cells.begin());
        const double d = optics::ciede2000(printed, printed + off[n] - slow[n]);
        squares += double(surface.cells[i].area_mm2) * d * d;
    }
    return std::sqrt(squares / area);
}

}  // namespace voxtone::slicer

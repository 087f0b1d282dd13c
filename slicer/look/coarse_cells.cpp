// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/coarse_cells.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/contracts.h"

namespace voxtone::slicer {

std::optional<CoarseCells> coarse_cells(const std::array<double, 3>& pitch_mm, double cell_mm) {
    CoarseCells cells{optics::cell_voxels(pitch_mm, eye_cell_mm), {}};
    bool larger = false;
    for (std::size_t a = 0; a < 3; ++a) {
        const int times = std::max(1, static_cast<int>(std::lround(cell_mm / (cells.eye[a] * pitch_mm[a]))));
        cells.coarse[a] = times * cells.eye[a];
        larger |= times > 1;
    }
    if (!larger) return std::nullopt;
    return cells;
}

std::array<int, 3> seen_cell_voxels(const std::array<double, 3>& pitch_mm, double cell_mm) {
    const auto cells = coarse_cells(pitch_mm, cell_mm);
    return cells ? cells->coarse : optics::cell_voxels(pitch_mm, cell_mm);
}

namespace {

/// Seen from above there is one cell in a column, at the mean height of what is seen: a step in it may be elsewhere.
std::array<std::int32_t, 3> place_of(std::array<std::int32_t, 3> cell, optics::SurfacePart part) {
    if (part == optics::SurfacePart::top) cell[2] = 0;
    return cell;
}

}  // namespace

SurfacePrediction averaged(const SurfacePrediction& fine, optics::Surface surface, optics::SurfacePart part) {
    std::array<int, 3> times{};
    for (std::size_t a = 0; a < 3; ++a) {
        times[a] = surface.cell_voxels[a] / fine.surface.cell_voxels[a];
        VOXTONE_EXPECT(times[a] * fine.surface.cell_voxels[a] == surface.cell_voxels[a]);
    }
    std::map<std::array<std::int32_t, 3>, std::size_t> place;
    for (std::size_t i = 0; i < surface.cells.size(); ++i) place.emplace(place_of(surface.cells[i].cell, part), i);

    SurfacePrediction mean;
    mean.channels = fine.channels;
    mean.remarks = fine.remarks;
    mean.value.assign(surface.cells.size() * fine.channels, 0);
    mean.rgb.assign(surface.cells.size(), Eigen::Vector3f::Zero());
    std::vector<float> area(surface.cells.size(), 0);
    for (std::size_t i = 0; i < fine.surface.cells.size(); ++i) {
        const optics::SurfaceCell& cell = fine.surface.cells[i];
        std::array<std::int32_t, 3> at{};
        for (std::size_t a = 0; a < 3; ++a) at[a] = cell.cell[a] / times[a];
        const auto found = place.find(place_of(at, part));
        VOXTONE_EXPECT(found != place.end());
        const std::size_t to = found->second;
        // A face that stands for no area still shows something.
        const float weight = std::max(cell.area_mm2, 1e-9f);
        area[to] += weight;
        mean.rgb[to] += weight * fine.rgb[i];
        for (std::size_t c = 0; c < fine.channels; ++c)
            mean.value[to * fine.channels + c] += weight * fine.value[i * fine.channels + c];
    }
    for (std::size_t i = 0; i < area.size(); ++i) {
        VOXTONE_EXPECT(area[i] > 0);
        mean.rgb[i] /= area[i];
        for (std::size_t c = 0; c < fine.channels; ++c) mean.value[i * fine.channels + c] /= area[i];
    }
    mean.surface = std::move(surface);
    return mean;
}

}  // namespace voxtone::slicer

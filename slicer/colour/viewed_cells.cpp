// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/viewed_cells.h"

#include "slicer/look/coarse_cells.h"
#include "slicer/part/backing_sheet.h"
#include "slicer/surface/target_cells.h"

namespace voxtone::slicer {

optics::Scene scene_of(const optics::ResinVolume& volume, const LoadedResins& resins, const JobBody& body,
                       const BackingChoice& under_picture) {
    optics::Scene scene{.volume = &volume, .resins = &resins.set, .spread_mm = resins.spread_mm};
    if (!body.is_picture) return scene;
    const Eigen::Vector3d& mm = body.placement.extent_mm;
    scene.backing = under_picture.kind;
    scene.sheet = sheet_under(under_picture, {mm.x(), mm.y()}, resins.set.channels);
    return scene;
}

optics::SurfacePart seen_part(const JobBody& body) {
    return body.is_picture ? optics::SurfacePart::top : optics::SurfacePart::all;
}

ViewedCells find_viewed_cells(const optics::Scene& scene, const JobBody& body, double cell_mm,
                              const Progress& progress) {
    ViewedCells cells;
    const std::array<double, 3>& pitch_mm = scene.volume->pitch_mm();
    const auto cell = seen_cell_voxels(pitch_mm, cell_mm);
    for (std::size_t a = 0; a < 3; ++a) cells.cell_um[a] = cell[a] * pitch_mm[a] * 1e3;
    cells.surface = optics::find_surface(scene, cell, seen_part(body), &progress);
    cells.target =
        target_of_cells(cells.surface, pitch_mm, body.grid.origin_mm, body.surface, body.model.mesh, &progress);
    return cells;
}

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
#include "suite_case.h"

#include <algorithm>
#include <map>

namespace voxtone::accuracy {

Groups group_cells(const SuiteCase& c, const optics::Surface& surface) {
    std::array<int, 3> cells{};
    for (std::size_t a = 0; a < 3; ++a) cells[a] = (c.volume.size()[a] + viewing_cell[a] - 1) / viewing_cell[a];
    Groups groups;
    std::map<std::array<int, 3>, std::uint32_t> known;
    for (std::size_t i = 0; i < surface.cells.size(); ++i) {
        std::array<int, 3> key = surface.cells[i].cell;
        switch (c.symmetry) {
            case Symmetry::none:
                break;
            case Symmetry::along_y:
                key[1] = 0;
                break;
            case Symmetry::mirror_xy:
                for (std::size_t a = 0; a < 2; ++a) key[a] = std::min(key[a], cells[a] - 1 - key[a]);
                break;
        }
        const auto [at, is_new] = known.try_emplace(key, static_cast<std::uint32_t>(groups.first_cell.size()));
        if (is_new) groups.first_cell.push_back(static_cast<std::uint32_t>(i));
        groups.of_cell.push_back(at->second);
    }
    return groups;
}

optics::Surface first_cells(const optics::Surface& surface, const Groups& groups) {
    optics::Surface some;
    some.cell_voxels = surface.cell_voxels;
    for (const std::uint32_t i : groups.first_cell) {
        optics::SurfaceCell cell = surface.cells[i];
        const std::size_t from = cell.first_face;
        cell.first_face = static_cast<std::uint32_t>(some.faces.size());
        for (std::size_t f = from; f < from + cell.faces; ++f) {
            some.faces.push_back(surface.faces[f]);
        }
        some.cells.push_back(cell);
        if (!surface.slope.empty()) some.slope.push_back(surface.slope[i]);
    }
    return some;
}

optics::ResinSet suite_resins() {
    optics::ResinSet set = optics::vero_opaque();
    optics::Resin clear;
    clear.name = "clear";
    clear.role.assign(1, 'T');
    clear.sigma_t_per_mm.assign(3, 0.0);
    clear.albedo.assign(3, 1.0);
    set.resins.push_back(clear);
    return set;
}

}  // namespace voxtone::accuracy

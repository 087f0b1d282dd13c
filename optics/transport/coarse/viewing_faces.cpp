// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which faces of the staircase of a viewing grid stand for the cells of a surface.
#include <cmath>
#include <utility>

#include "voxtone/optics/transport/coarse/viewing_grid.h"
#include "voxtone/optics/transport/lattice.h"

namespace voxtone::optics {

ViewingGrid::Seen ViewingGrid::see(const Surface& surface) const {
    // Places around a cell, near ones first.
    constexpr int reach = 2;
    std::array<double, 3> edge{};
    for (std::size_t a = 0; a < 3; ++a) edge[a] = grid.options.view_voxels[a] * grid.pitch_mm[a];
    Seen seen;
    std::vector<std::pair<std::uint32_t, double>> near;
    seen.first.reserve(surface.cells.size() + 1);
    seen.cell.reserve(surface.cells.size());
    seen.first.push_back(0);
    for (const SurfaceCell& cell : surface.cells) {
        std::array<double, 6> area{};
        for (std::size_t f = cell.first_face; f < cell.first_face + cell.faces; ++f) {
            const auto facing = static_cast<std::size_t>(surface.faces[f].facing), a = facing / 2;
            area[facing] += grid.pitch_mm[(a + 1) % 3] * grid.pitch_mm[(a + 2) % 3];
        }
        Place home{};
        for (std::size_t a = 0; a < 3; ++a) {
            // Half a hair inside, so that faces of a cell that is met exactly are its own.
            const double at =
                static_cast<double>(cell.centre_mm[a]) / grid.pitch_mm[a] - 1e-3 * static_cast<double>(cell.normal[a]);
            home[a] = (static_cast<int>(std::floor(at)) + grid.shift_voxels[a]) / grid.options.view_voxels[a];
        }
        const auto distance2 = [&](const Place& at, int facing) {
            double sum = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                double middle = (at[a] + 0.5) * edge[a] - grid.shift_voxels[a] * grid.pitch_mm[a];
                if (facing / 2 == static_cast<int>(a) && facing >= 0) middle += (facing % 2 ? 0.5 : -0.5) * edge[a];
                sum += std::pow(middle - static_cast<double>(cell.centre_mm[a]), 2);
            }
            return sum;
        };
        // On a slanting surface the light of the steps near by, so that a picture does not show them.
        const bool slanting =
            std::max({std::abs(cell.normal[0]), std::abs(cell.normal[1]), std::abs(cell.normal[2])}) < 0.999f;
        constexpr double blur = 0.05;  // mm
        if (slanting) {
            near.clear();
            std::array<double, 6> weights{};
            for_each({3, 3, 3}, [&](const Place& k) {
                const Place at{home[0] + k[0] - 1, home[1] + k[1] - 1, home[2] + k[2] - 1};
                const std::int64_t there = cell_of(at);
                if (there < 0) return;
                each_face(static_cast<std::uint32_t>(there), [&](std::uint32_t f) {
                    const auto facing = static_cast<std::size_t>(grid.faces[f].facing);
                    if (grid.faces[f].kind != FaceKind::light || area[facing] == 0) return;
                    const double weight = std::exp(-0.5 * distance2(at, static_cast<int>(facing)) / (blur * blur));
                    weights[facing] += weight;
                    near.push_back({f, weight});
                });
            });
            bool all = true;
            for (std::size_t f = 0; f < 6; ++f) all &= area[f] == 0 || weights[f] > 0;
            if (all) {
                for (const auto& [f, weight] : near) {
                    const auto facing = static_cast<std::size_t>(grid.faces[f].facing);
                    const double share = weight / weights[facing];
                    if (share < 0.01) continue;
                    seen.face.push_back(f);
                    seen.share.push_back(
                        static_cast<float>(share * area[facing] / static_cast<double>(grid.faces[f].area_mm2)));
                }
                seen.first.push_back(static_cast<std::uint32_t>(seen.face.size()));
                seen.cell.push_back(grid.faces[near[0].first].cell);
                continue;
            }
        }
        std::array<double, 6> nearest{};
        std::array<std::int64_t, 6> found{};
        nearest.fill(1e9);
        found.fill(-1);
        double nearest_cell = 1e9, nearest_any = 1e9;
        std::int64_t solid = -1, any = -1;
        for (int r = 1; r <= reach; ++r) {
            bool all = true;
            for_each({2 * r + 1, 2 * r + 1, 2 * r + 1}, [&](const Place& k) {
                const Place at{home[0] + k[0] - r, home[1] + k[1] - r, home[2] + k[2] - r};
                const std::int64_t there = cell_of(at);
                if (there < 0) return;
                if (const double d = distance2(at, -1); d < nearest_cell) {
                    nearest_cell = d;
                    solid = there;
                }
                each_face(static_cast<std::uint32_t>(there), [&](std::uint32_t f) {
                    const OuterFace& face = grid.faces[f];
                    if (face.kind != FaceKind::light) return;
                    const auto facing = static_cast<std::size_t>(face.facing);
                    const double d = distance2(at, static_cast<int>(facing));
                    const double towards = static_cast<double>(cell.normal[facing / 2]) * (facing % 2 ? 1 : -1);
                    if (d < nearest[facing]) {
                        nearest[facing] = d;
                        found[facing] = f;
                    }
                    if (towards > 0 && d < nearest_any) {
                        nearest_any = d;
                        any = f;
                    }
                });
            });
            for (std::size_t f = 0; f < 6; ++f) all &= area[f] == 0 || found[f] >= 0;
            if (all) break;
        }
        for (std::size_t f = 0; f < 6; ++f) {
            if (area[f] == 0) continue;
            const std::int64_t face = found[f] >= 0 ? found[f] : any;
            if (face < 0) continue;
            seen.face.push_back(static_cast<std::uint32_t>(face));
            seen.share.push_back(
                static_cast<float>(area[f] / static_cast<double>(grid.faces[static_cast<std::size_t>(face)].area_mm2)));
        }
        seen.first.push_back(static_cast<std::uint32_t>(seen.face.size()));
        seen.cell.push_back(solid < 0 ? 0xffffffffu : static_cast<std::uint32_t>(solid));
    }
    return seen;
}

}  // namespace voxtone::optics

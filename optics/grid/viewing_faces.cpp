// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/grid/viewing_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include "base/parallel.h"
#include "optics/grid/lattice.h"

namespace voxtone::optics {
namespace {

// About half a cell. The textured sphere of the suite is 1.80, 1.83 and 2.24 off with 0.025, 0.05 and 0.1 mm
// refined, 2.01, 1.98 and 2.31 on whole cells (`predictor_accuracy compare --only sphere`); no other case of it is
// curved.
constexpr double blur_mm = 0.05;
constexpr double least_share = 0.01;  // of a cell's faces of one facing: fainter ones are left out
constexpr int cells_around = 2;       // cells around that are looked at

/// Looks for the faces of one surface cell after the other.
class FaceFinder {
public:
    FaceFinder(const ViewingGrid& grid, const Surface& surface) : grid_(grid), surface_(surface) {
        for (std::size_t a = 0; a < 3; ++a) edge_[a] = grid_.view_voxels[a] * grid_.pitch_mm[a];
    }
    /// Those of the cells begin .. end - 1, as if there were no others.
    [[nodiscard]] ViewingFaces run(std::size_t begin, std::size_t end, const Progress* progress) {
        seen_.first.push_back(0);
        for (const SurfaceCell& cell : std::span(surface_.cells).subspan(begin, end - begin)) {
            if (progress) progress->check_cancelled();
            look_at(cell);
            if (!is_slanting(cell) || !share_around(cell)) take_nearest(cell);
            seen_.first.push_back(static_cast<std::uint32_t>(seen_.face.size()));
        }
        return std::move(seen_);
    }

private:
    static bool is_slanting(const SurfaceCell& cell) {
        return std::max({std::abs(cell.normal[0]), std::abs(cell.normal[1]), std::abs(cell.normal[2])}) < 0.999f;
    }

    /// Areas of its faces, and where it lies.
    void look_at(const SurfaceCell& cell) {
        area_ = {};
        for (std::size_t f = cell.first_face; f < cell.first_face + cell.faces; ++f) {
            const auto facing = static_cast<std::size_t>(surface_.faces[f].facing), a = facing / 2;
            area_[facing] += grid_.pitch_mm[(a + 1) % 3] * grid_.pitch_mm[(a + 2) % 3];
        }
        for (std::size_t a = 0; a < 3; ++a) {
            // Half a hair inside, so that faces of a cell that is met exactly are its own.
            const double at =
                static_cast<double>(cell.centre_mm[a]) / grid_.pitch_mm[a] - 1e-3 * static_cast<double>(cell.normal[a]);
            home_[a] = (static_cast<int>(std::floor(at)) + grid_.shift_voxels[a]) / grid_.view_voxels[a];
        }
    }

    /// From the surface cell to the middle of a face of a grid cell, or of the cell itself (facing -1).
    [[nodiscard]] double distance2(const SurfaceCell& cell, const Place& at, int facing) const {
        double sum = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            double middle = (at[a] + 0.5) * edge_[a] - grid_.shift_voxels[a] * grid_.pitch_mm[a];
            if (facing / 2 == static_cast<int>(a) && facing >= 0) middle += (facing % 2 ? 0.5 : -0.5) * edge_[a];
            sum += std::pow(middle - static_cast<double>(cell.centre_mm[a]), 2);
        }
        return sum;
    }

    /// body(place, grid cell) of the solid ones up to r places away.
    template <class Body>
    void each_cell_near(int r, Body&& body) const {
        for_each({2 * r + 1, 2 * r + 1, 2 * r + 1}, [&](const Place& k) {
            const Place at{home_[0] + k[0] - r, home_[1] + k[1] - r, home_[2] + k[2] - r};
            if (const std::int64_t there = grid_.cell_of(at); there >= 0) body(at, there);
        });
    }

    void add(std::uint32_t face, double area) {
        seen_.face.push_back(face);
        seen_.share.push_back(static_cast<float>(area / static_cast<double>(grid_.faces[face].area_mm2)));
    }

    /// On a slanting surface the light of the steps near by. False, and nothing done, where a facing finds no face.
    [[nodiscard]] bool share_around(const SurfaceCell& cell) {
        near_.clear();
        std::array<double, 6> weights{};
        each_cell_near(1, [&](const Place& at, std::int64_t there) {
            grid_.each_face(static_cast<std::uint32_t>(there), [&](std::uint32_t f) {
                const auto facing = static_cast<std::size_t>(grid_.faces[f].facing);
                if (grid_.faces[f].kind != FaceKind::light || area_[facing] == 0) return;
                const double weight =
                    std::exp(-0.5 * distance2(cell, at, static_cast<int>(facing)) / (blur_mm * blur_mm));
                weights[facing] += weight;
                near_.push_back({f, weight});
            });
        });
        for (std::size_t f = 0; f < 6; ++f)
            if (area_[f] != 0 && !(weights[f] > 0)) return false;
        for (const auto& [f, weight] : near_) {
            const auto facing = static_cast<std::size_t>(grid_.faces[f].facing);
            const double share = weight / weights[facing];
            if (share >= least_share) add(f, share * area_[facing]);
        }
        seen_.cell.push_back(grid_.faces[near_[0].first].cell);
        return true;
    }

    struct Nearest {
        double distance2 = 1e9;
        std::int64_t index = -1;
        void take(double d2, std::int64_t i) {
            if (d2 >= distance2) return;
            distance2 = d2;
            index = i;
        }
    };

    void take_nearest(const SurfaceCell& cell) {
        std::array<Nearest, 6> nearest{};
        Nearest solid, any;
        for (int r = 1; r <= cells_around; ++r) {
            each_cell_near(r, [&](const Place& at, std::int64_t there) {
                solid.take(distance2(cell, at, -1), there);
                grid_.each_face(static_cast<std::uint32_t>(there), [&](std::uint32_t f) {
                    const OuterFace& face = grid_.faces[f];
                    if (face.kind != FaceKind::light) return;
                    const auto facing = static_cast<std::size_t>(face.facing);
                    const double d2 = distance2(cell, at, static_cast<int>(facing));
                    const double towards = static_cast<double>(cell.normal[facing / 2]) * (facing % 2 ? 1 : -1);
                    nearest[facing].take(d2, f);
                    if (towards > 0) any.take(d2, f);
                });
            });
            bool all = true;
            for (std::size_t f = 0; f < 6; ++f) all &= area_[f] == 0 || nearest[f].index >= 0;
            if (all) break;
        }
        for (std::size_t f = 0; f < 6; ++f) {
            if (area_[f] == 0) continue;
            const std::int64_t face = nearest[f].index >= 0 ? nearest[f].index : any.index;
            if (face >= 0) add(static_cast<std::uint32_t>(face), area_[f]);
        }
        seen_.cell.push_back(solid.index < 0 ? no_cell : static_cast<std::uint32_t>(solid.index));
    }

    const ViewingGrid& grid_;
    const Surface& surface_;
    std::array<double, 3> edge_{};  ///< of a grid cell
    std::array<double, 6> area_{};  ///< of the cell's faces, by facing
    Place home_{};                  ///< grid cell of its centre
    std::vector<std::pair<std::uint32_t, double>> near_;
    ViewingFaces seen_;
};

}  // namespace

ViewingFaces find_viewing_faces(const ViewingGrid& grid, const Surface& surface, const Progress* progress) {
    constexpr std::size_t part = 1 << 12;
    std::vector<ViewingFaces> parts((surface.cells.size() + part - 1) / part);
    parallel_for(0, parts.size(), 1, [&](std::size_t p) {
        parts[p] = FaceFinder(grid, surface).run(p * part, std::min((p + 1) * part, surface.cells.size()), progress);
    });
    std::size_t entries = 0;
    for (const ViewingFaces& one : parts) entries += one.face.size();
    ViewingFaces seen;
    seen.first.reserve(surface.cells.size() + 1);
    seen.cell.reserve(surface.cells.size());
    seen.face.reserve(entries);
    seen.share.reserve(entries);
    seen.first.push_back(0);
    for (ViewingFaces& one : parts) {
        const auto before = static_cast<std::uint32_t>(seen.face.size());
        for (std::size_t i = 1; i < one.first.size(); ++i) seen.first.push_back(before + one.first[i]);
        seen.cell.insert(seen.cell.end(), one.cell.begin(), one.cell.end());
        seen.face.insert(seen.face.end(), one.face.begin(), one.face.end());
        seen.share.insert(seen.share.end(), one.share.begin(), one.share.end());
        one = {};
    }
    return seen;
}

namespace {

using Normal = std::array<float, 3>;

float length(const Normal& n) { return std::hypot(n[0], n[1], n[2]); }

void add_to(Normal& sum, const Normal& n) {
    for (std::size_t a = 0; a < 3; ++a) sum[a] += n[a];
}

/// Of each face of the grid: the sum of those of the voxel faces that are seen through it.
std::vector<Normal> normals_of_faces(const ViewingGrid& grid, const Scene& scene, const Progress* progress) {
    const Place block = grid.block_voxels();
    VoxelBox box;
    for (std::size_t a = 0; a < 3; ++a) {
        box.begin[a] = -grid.shift_voxels[a];
        box.end[a] = box.begin[a] + grid.lattice[a] * block[a];
    }
    const Surface surface = find_surface_near(scene, grid.view_voxels, box, progress);
    const ViewingFaces seen = find_viewing_faces(grid, surface, progress);
    std::vector<Normal> normal(grid.faces.size());
    for (std::size_t i = 0; i < surface.cells.size(); ++i) {
        const SurfaceCell& cell = surface.cells[i];
        for (std::uint32_t e = seen.first[i]; e < seen.first[i + 1]; ++e)
            for (std::size_t f = cell.first_face; f < cell.first_face + cell.faces; ++f)
                if (surface.faces[f].facing == grid.faces[seen.face[e]].facing)
                    add_to(normal[seen.face[e]], surface.normal_at(i, f));
    }
    return normal;
}

/// Which way the nearest surface lies: the main direction of the normals in each block, of its neighbours' where it
/// has none.
void find_ways(ViewingGrid& grid, const std::vector<Normal>& normal) {
    const std::size_t n = grid.transport_blocks.size();
    std::vector<Normal> way(n);
    std::vector<std::uint32_t> front, next;
    std::vector<std::uint8_t> known(n, 0);
    for (std::size_t t = 0; t < n; ++t) {
        const GridBlock& block = grid.transport_block(t);
        for (std::size_t f = block.first_face; f < block.first_face + block.faces; ++f) add_to(way[t], normal[f]);
        if (way[t] == Normal{}) continue;
        known[t] = 1;
        front.push_back(static_cast<std::uint32_t>(t));
    }
    for (; !front.empty(); front.swap(next)) {
        next.clear();
        for (const std::uint32_t t : front)
            for (const std::int32_t other : grid.transport_block(t).neighbour) {
                if (other < 0 || grid.blocks[static_cast<std::size_t>(other)].kind == BlockKind::core) continue;
                const std::uint32_t to = grid.blocks[static_cast<std::size_t>(other)].first_cell / 64;
                if (known[to] == 1) continue;
                if (known[to] == 0) next.push_back(to);
                known[to] = 2;
                add_to(way[to], way[t]);
            }
        for (const std::uint32_t t : next) known[t] = 1;
    }
    grid.towards.assign(n, static_cast<std::uint8_t>(Facing::plus_z));
    for (std::size_t t = 0; t < n; ++t) {
        std::size_t axis = 2;
        for (std::size_t a = 0; a < 3; ++a)
            if (std::abs(way[t][a]) > std::abs(way[t][axis])) axis = a;
        grid.towards[t] = static_cast<std::uint8_t>(2 * axis + (way[t][axis] >= 0 ? 1 : 0));
    }
}

/// Sum of the normals of the faces of the cells around that look partly the way of this one.
Normal normal_near(const ViewingGrid& grid, std::uint32_t f, const std::vector<Normal>& normal) {
    const OuterFace& face = grid.faces[f];
    const GridBlock& block = grid.transport_block(face.cell / 64);
    const int place = static_cast<int>(face.cell % 64);
    const Place cell{4 * block.at[0] + place % 4, 4 * block.at[1] + place / 4 % 4, 4 * block.at[2] + place / 16};
    const auto axis = static_cast<std::size_t>(face.facing) / 2;
    const float sign = static_cast<int>(face.facing) % 2 ? 1.0f : -1.0f;
    Normal sum{};
    for_each({3, 3, 3}, [&](const Place& k) {
        const std::int64_t other = grid.cell_of({cell[0] + k[0] - 1, cell[1] + k[1] - 1, cell[2] + k[2] - 1});
        if (other < 0) return;
        grid.each_face(static_cast<std::uint32_t>(other), [&](std::uint32_t g) {
            if (normal[g][axis] * sign > 0) add_to(sum, normal[g]);
        });
    });
    return sum;
}

/// Numbers of laws in the grid: 0 of a mirror, those of flat faces across x, y and z, then slanting ones, whose normals
/// are told apart in steps of 1/48.
class LawTable {
public:
    explicit LawTable(ViewingGrid& grid) : grid_(grid) {
        grid.laws.push_back(mirror_law());
        for (std::size_t axis = 0; axis < 3; ++axis) {
            Normal n{};
            n[axis] = 1;
            add(axis, n);
        }
    }
    [[nodiscard]] static std::uint32_t flat(std::size_t axis) { return 1 + static_cast<std::uint32_t>(axis); }
    /// `normal`: of any length.
    [[nodiscard]] std::uint32_t of(Facing facing, Normal n) {
        const auto axis = static_cast<std::size_t>(facing) / 2;
        const float sign = static_cast<int>(facing) % 2 ? 1.0f : -1.0f, l = length(n);
        if (!(l > 0)) return flat(axis);
        for (float& v : n) v /= l;
        if (n[axis] * sign <= 0.01f || n[axis] * sign > 0.99999f) return flat(axis);
        const std::size_t b = axis == 0 ? 1 : 0, c = axis == 2 ? 1 : 2;
        constexpr float steps = 48;
        const std::array<int, 3> key{static_cast<int>(axis), static_cast<int>(std::lround(steps * n[b])),
                                     static_cast<int>(std::lround(steps * n[c]))};
        const auto [found, fresh] = known_.try_emplace(key, static_cast<std::uint32_t>(grid_.laws.size()));
        if (fresh) {
            Normal rounded{};
            rounded[b] = static_cast<float>(key[1]) / steps;
            rounded[c] = static_cast<float>(key[2]) / steps;
            rounded[axis] = std::sqrt(std::max(1e-4f, 1 - rounded[b] * rounded[b] - rounded[c] * rounded[c]));
            add(axis, rounded);
        }
        return found->second;
    }
    /// After the last: all of them once more for each index that the surface may have.
    void repeat_by_index() {
        if (grid_.eta_step.empty()) return;
        grid_.laws_of_one = grid_.laws.size();
        for (std::size_t step = 0; step < eta_steps; ++step) {
            const double t = static_cast<double>(step) / (eta_steps - 1);
            const DirectionSet set =
                under_surface(grid_.directions, grid_.eta_range[0] + t * (grid_.eta_range[1] - grid_.eta_range[0]));
            grid_.laws.push_back(mirror_law());
            for (const auto& [axis, n] : made_) grid_.laws.push_back(face_law(set, axis, n));
        }
    }

private:
    void add(std::size_t axis, const Normal& n) {
        made_.emplace_back(static_cast<int>(axis), n);
        grid_.laws.push_back(face_law(grid_.directions, static_cast<int>(axis), n));
    }

    ViewingGrid& grid_;
    std::vector<std::pair<int, Normal>> made_;  ///< all but the first
    std::map<std::array<int, 3>, std::uint32_t> known_;
};

}  // namespace

void find_face_laws(ViewingGrid& grid, const Scene& scene, const Progress* progress) {
    const std::vector<Normal> normal = normals_of_faces(grid, scene, progress);
    find_ways(grid, normal);
    LawTable laws(grid);
    grid.law.assign(grid.faces.size(), 0);
    for (const std::uint32_t f : grid.open_faces) {
        if (progress) progress->check_cancelled();
        const OuterFace& face = grid.faces[f];
        if (face.kind == FaceKind::light)
            grid.law[f] = laws.of(face.facing, length(normal[f]) == 0 ? normal_near(grid, f, normal) : normal[f]);
        else if (face.kind != FaceKind::mirror)
            grid.law[f] = LawTable::flat(static_cast<std::size_t>(face.facing) / 2);
    }
    laws.repeat_by_index();
    for (const std::uint32_t b : grid.transport_blocks) {
        GridBlock& block = grid.blocks[b];
        for (std::size_t f = block.first_face; f < block.first_face + block.faces; ++f)
            block.slanting |= !grid.law_of(f).flat;
    }
}

void choose_face_indices(ViewingGrid& grid) {
    const std::size_t n = grid.laws_of_one;
    if (n == 0) return;
    std::array<std::vector<std::uint32_t>, 3> first_law;  // of each mixture, towards each axis
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const Mixture& mixture : grid.mixtures) {
            float sum = 0, share = 0;
            for (const Holding& hold : mixture.holds) {
                if (mixture.axis == axis && hold.layer != mixture.holds.front().layer) continue;
                sum += hold.share * grid.eta_step[hold.material - 1u];
                share += hold.share;
            }
            const auto step = share > 0 ? 1 + static_cast<std::uint32_t>(std::lround(sum / share)) : 0;
            first_law[axis].push_back(step * static_cast<std::uint32_t>(n));
        }
    for (const std::uint32_t f : grid.open_faces) {
        const OuterFace& face = grid.faces[f];
        grid.law[f] = grid.law[f] % static_cast<std::uint32_t>(n) +
                      first_law[static_cast<std::size_t>(face.facing) / 2][grid.medium[face.cell]];
    }
}

}  // namespace voxtone::optics

// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/scene/surface.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <tuple>
#include <type_traits>

#include "base/contracts.h"
#include "base/error.h"
#include "base/parallel.h"
#include "optics/media/mirrored_box.h"

namespace voxtone::optics {
namespace {

// Degrees rms between normals and the true ones, on a J750's voxels. By sigma 0.06, 0.12, 0.18, 0.24, reach 2.5 sigma:
// a sphere of 6 mm 4.3, 1.5, 1.3, 1.3; within 0.5 mm of a roof's ridge 5.4, 10.3, 12.6, 13.9. By reach 0.24, 0.3: the
// sphere 2.0, 1.5. By terraces of 0.25, 0.5, 1: the sphere 3.8, 1.5, 1.3; bent of ribs 0.7 mm wide 13, 13, 46 % of the
// surface.
constexpr double kernel_sigma_mm = 0.12, kernel_reach_mm = 0.3, terrace_mm = 0.5;

constexpr int most_voxels = 1 << 16;  // SurfaceFace::voxel

SurfaceFace face_of(const std::array<int, 3>& voxel, Facing facing, bool slants) {
    SurfaceFace face{{}, facing, slants};
    for (std::size_t a = 0; a < 3; ++a) face.voxel[a] = static_cast<std::uint16_t>(voxel[a]);
    return face;
}

/// A box of voxels with a margin, so that everything about a tile's faces is decided without looking elsewhere.
struct Patch {
    std::array<int, 3> corner{}, extent{};
    std::vector<Material> voxels;
    std::vector<std::int32_t> filled;  ///< solid voxels of each viewing cell within the kernel's reach of the tile
    [[nodiscard]] const Material* row(int x, int y, int z) const {
        return voxels.data() +
               (static_cast<std::size_t>(z - corner[2]) * static_cast<std::size_t>(extent[1]) +
                static_cast<std::size_t>(y - corner[1])) *
                   static_cast<std::size_t>(extent[0]) +
               static_cast<std::size_t>(x - corner[0]);
    }
    [[nodiscard]] bool solid(int x, int y, int z) const { return *row(x, y, z) != air; }
};

class TileSurface {
public:
    TileSurface(const Scene& scene, const std::array<int, 3>& cell) : scene_(scene), cell_(cell) {
        const auto& pitch = scene.volume->pitch_mm();
        for (std::size_t a = 0; a < 3; ++a) {
            reach_[a] = static_cast<int>(std::floor(kernel_reach_mm / (cell[a] * pitch[a])));
            terrace_[a] = static_cast<int>(std::ceil(terrace_mm / pitch[a]));
            margin_[a] = std::max((reach_[a] + 1) * cell[a], terrace_[a] + 1);
            edge_[a] = cell[a] * std::max(1, (a == 2 ? 24 : 16) / cell[a]);
        }
        for (int z = -reach_[2]; z <= reach_[2]; ++z)
            for (int y = -reach_[1]; y <= reach_[1]; ++y)
                for (int x = -reach_[0]; x <= reach_[0]; ++x) {
                    const std::array<double, 3> at{x * cell[0] * pitch[0], y * cell[1] * pitch[1],
                                                   z * cell[2] * pitch[2]};
                    const double r2 = at[0] * at[0] + at[1] * at[1] + at[2] * at[2];
                    if (r2 == 0 || r2 > kernel_reach_mm * kernel_reach_mm) continue;
                    const double w = std::exp(-0.5 * r2 / (kernel_sigma_mm * kernel_sigma_mm));
                    const std::array<int, 3> n = counted();
                    kernel_.push_back(
                        {(static_cast<std::ptrdiff_t>(z) * n[1] + y) * n[0] + x, {at[0] * w, at[1] * w, at[2] * w}});
                }
    }
    [[nodiscard]] const std::array<int, 3>& edge() const { return edge_; }

    /// Appends the cells and faces of the tile whose lowest voxel is `corner`.
    void append(const std::array<int, 3>& corner, Surface& out) const {
        const ResinVolume& volume = *scene_.volume;
        const std::array<int, 3> around{corner[0] - 1, corner[1] - 1, corner[2] - 1};
        const std::array<int, 3> extent{edge_[0] + 2, edge_[1] + 2, edge_[2] + 2};
        const int material = volume.uniform_material(around, extent);
        if (material == air) return;
        if (material > 0) return;
        Patch patch;
        for (std::size_t a = 0; a < 3; ++a) {
            patch.corner[a] = corner[a] - margin_[a];
            patch.extent[a] = edge_[a] + 2 * margin_[a];
        }
        read_box(*scene_.volume, scene_.sides == Sides::mirrored, patch.corner, patch.extent, patch.voxels);
        count_cells(corner, patch);
        for (int z = corner[2]; z < corner[2] + edge_[2]; z += cell_[2])
            for (int y = corner[1]; y < corner[1] + edge_[1]; y += cell_[1])
                for (int x = corner[0]; x < corner[0] + edge_[0]; x += cell_[0])
                    append_cell(patch, corner, {x, y, z}, out);
    }

private:
    struct Tap {
        std::ptrdiff_t step;  ///< between places of Patch::filled
        std::array<double, 3> weight;
    };

    void append_cell(const Patch& patch, const std::array<int, 3>& corner, const std::array<int, 3>& low,
                     Surface& out) const {
        if (no_faces(patch, corner, low)) return;
        const auto& size = scene_.volume->size();
        const auto& pitch = scene_.volume->pitch_mm();
        SurfaceCell cell;
        cell.first_face = static_cast<std::uint32_t>(out.faces.size());
        std::array<double, 3> centre{}, normal{}, smooth{};
        double area = 0;
        for (int z = low[2]; z < std::min(low[2] + cell_[2], size[2]); ++z)
            for (int y = low[1]; y < std::min(low[1] + cell_[1], size[1]); ++y)
                for (int x = low[0]; x < std::min(low[0] + cell_[0], size[0]); ++x) {
                    if (!patch.solid(x, y, z)) continue;
                    for (int f = 0; f < 6; ++f) {
                        const auto& s = step_of[static_cast<std::size_t>(f)];
                        if (patch.solid(x + s[0], y + s[1], z + s[2])) continue;
                        if (scene_.backing != Backing::none && f == 4 && z == 0) continue;
                        const auto axis = static_cast<std::size_t>(f / 2);
                        std::array<double, 3> n{};
                        bool slants = false;
                        if (on_terrace(patch, {x, y, z}, f)) {
                            n[axis] = s[axis];
                        } else {
                            if (smooth[0] == 0 && smooth[1] == 0 && smooth[2] == 0)
                                smooth = gradient(patch, corner, low);
                            slants = smooth[axis] * s[axis] > 0;  // else a kink that the smooth surface does not have
                            if (slants)
                                n = smooth;
                            else
                                n[axis] = s[axis];
                        }
                        const double a = pitch[(axis + 1) % 3] * pitch[(axis + 2) % 3];
                        const double stands_for = a / (std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]));
                        const std::array<int, 3> at{x, y, z};
                        for (std::size_t k = 0; k < 3; ++k) {
                            centre[k] += stands_for * pitch[k] * (at[k] + 0.5 + (k == axis ? 0.5 * s[k] : 0.0));
                            normal[k] += stands_for * n[k];
                        }
                        area += stands_for;
                        out.faces.push_back(face_of(at, static_cast<Facing>(f), slants));
                        ++cell.faces;
                    }
                }
        if (cell.faces == 0) return;
        const double length = std::hypot(normal[0], normal[1], normal[2]);
        for (std::size_t k = 0; k < 3; ++k) {
            cell.cell[k] = low[k] / cell_[k];
            cell.centre_mm[k] = static_cast<float>(centre[k] / area);
            cell.normal[k] = static_cast<float>(length > 1e-9 * area ? normal[k] / length : (k == 2 ? 1.0 : 0.0));
        }
        cell.area_mm2 = static_cast<float>(area);
        out.cells.push_back(cell);
        out.slope.push_back(
            {static_cast<float>(smooth[0]), static_cast<float>(smooth[1]), static_cast<float>(smooth[2])});
    }

    [[nodiscard]] bool on_terrace(const Patch& patch, const std::array<int, 3>& at, int f) const {
        const auto& s = step_of[static_cast<std::size_t>(f)];
        const auto exposed = [&](const std::array<int, 3>& v) {
            return patch.solid(v[0], v[1], v[2]) && !patch.solid(v[0] + s[0], v[1] + s[1], v[2] + s[2]);
        };
        for (std::size_t a = 0; a < 3; ++a) {
            if (s[a] != 0) continue;
            int run = 1;
            for (const int way : {1, -1}) {
                std::array<int, 3> v = at;
                for (int k = 1; k < terrace_[a] && run < terrace_[a]; ++k) {
                    v[a] += way;
                    if (!exposed(v)) break;
                    ++run;
                }
            }
            if (run < terrace_[a]) return false;
        }
        return true;
    }

    [[nodiscard]] std::array<int, 3> counted() const {
        std::array<int, 3> n{};
        for (std::size_t a = 0; a < 3; ++a) n[a] = edge_[a] / cell_[a] + 2 * reach_[a];
        return n;
    }

    void count_cells(const std::array<int, 3>& corner, Patch& patch) const {
        const std::array<int, 3> n = counted();
        patch.filled.assign(
            static_cast<std::size_t>(n[0]) * static_cast<std::size_t>(n[1]) * static_cast<std::size_t>(n[2]), 0);
        std::size_t i = 0;
        for (int cz = 0; cz < n[2]; ++cz)
            for (int cy = 0; cy < n[1]; ++cy)
                for (int cx = 0; cx < n[0]; ++cx, ++i) {
                    const int x0 = corner[0] + (cx - reach_[0]) * cell_[0],
                              y0 = corner[1] + (cy - reach_[1]) * cell_[1],
                              z0 = corner[2] + (cz - reach_[2]) * cell_[2];
                    std::int32_t sum = 0;
                    for (int z = z0; z < z0 + cell_[2]; ++z)
                        for (int y = y0; y < y0 + cell_[1]; ++y) {
                            const Material* const row = patch.row(x0, y, z);
                            for (int x = 0; x < cell_[0]; ++x) sum += row[x] != air;
                        }
                    patch.filled[i] = sum;
                }
    }

    /// The count of a cell of the tile.
    [[nodiscard]] const std::int32_t* count_of(const Patch& patch, const std::array<int, 3>& corner,
                                               const std::array<int, 3>& low) const {
        const std::array<int, 3> n = counted();
        std::array<std::ptrdiff_t, 3> home{};
        for (std::size_t a = 0; a < 3; ++a) home[a] = (low[a] - corner[a]) / cell_[a] + reach_[a];
        return patch.filled.data() + (home[2] * n[1] + home[1]) * n[0] + home[0];
    }

    /// Neither it nor a neighbour has a surface, as all are solid, or it is air.
    [[nodiscard]] bool no_faces(const Patch& patch, const std::array<int, 3>& corner,
                                const std::array<int, 3>& low) const {
        const std::int32_t* const here = count_of(patch, corner, low);
        if (*here == 0) return true;
        const std::array<int, 3> n = counted();
        const std::int32_t whole = cell_[0] * cell_[1] * cell_[2];
        std::ptrdiff_t step = 1;
        for (std::size_t a = 0; a < 3; step *= n[a], ++a)
            if (*here != whole || reach_[a] == 0 || here[-step] != whole || here[step] != whole) return false;
        return true;
    }

    [[nodiscard]] std::array<double, 3> gradient(const Patch& patch, const std::array<int, 3>& corner,
                                                 const std::array<int, 3>& low) const {
        const std::int32_t* const here = count_of(patch, corner, low);
        std::array<double, 3> n{};
        for (const Tap& tap : kernel_) {
            const std::int32_t filled = here[tap.step];
            for (std::size_t k = 0; k < 3; ++k) n[k] -= filled * tap.weight[k];
        }
        const double length = std::hypot(n[0], n[1], n[2]);
        if (length < 1e-9) return {};  // alike in opposite directions: what is left is rounding, no direction
        for (double& v : n) v /= length;
        return n;
    }

    const Scene& scene_;
    std::array<int, 3> cell_, edge_{}, margin_{}, reach_{}, terrace_{};
    std::vector<Tap> kernel_;
};

void append(Surface& to, const Surface& from) {
    const auto offset = static_cast<std::uint32_t>(to.faces.size());
    for (SurfaceCell cell : from.cells) {
        cell.first_face += offset;
        to.cells.push_back(cell);
    }
    to.faces.insert(to.faces.end(), from.faces.begin(), from.faces.end());
    to.slope.insert(to.slope.end(), from.slope.begin(), from.slope.end());
}

/// In order of z, y, x of the viewing grid.
void sort_cells(Surface& surface) {
    std::vector<std::uint32_t> order(surface.cells.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto place = [&](std::uint32_t i) {
        const auto& at = surface.cells[i].cell;
        return std::tuple(at[2], at[1], at[0]);
    };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return place(a) < place(b); });
    const auto sorted = [&](const auto& values) {
        std::remove_cvref_t<decltype(values)> in_order;
        in_order.reserve(values.size());
        for (const std::uint32_t i : order) in_order.push_back(values[i]);
        return in_order;
    };
    surface.cells = sorted(surface.cells);
    if (!surface.slope.empty()) surface.slope = sorted(surface.slope);
}

/// Of the tiles that touch the box.
Surface surface_near(const Scene& scene, const std::array<int, 3>& cell, const VoxelBox& box,
                     const Progress* progress) {
    const TileSurface tiles(scene, cell);
    const auto& size = scene.volume->size();
    std::array<int, 3> first{}, n{};
    for (std::size_t a = 0; a < 3; ++a) {
        const int tile = tiles.edge()[a], last = std::min(box.end[a], size[a]);
        first[a] = std::max(box.begin[a], 0) / tile;
        n[a] = std::max(0, (last + tile - 1) / tile - first[a]);
    }
    const auto across = static_cast<std::size_t>(n[1]);
    std::vector<Surface> rows(across * static_cast<std::size_t>(n[2]));
    const auto look_along = [&](std::size_t row) {
        for (int x = 0; x < n[0]; ++x)
            tiles.append(
                {(first[0] + x) * tiles.edge()[0], (first[1] + static_cast<int>(row % across)) * tiles.edge()[1],
                 (first[2] + static_cast<int>(row / across)) * tiles.edge()[2]},
                rows[row]);
    };
    parallel_for(0, rows.size(), 1, look_along, progress);
    Surface all;
    for (Surface& row : rows) {
        append(all, row);
        row = {};
    }
    sort_cells(all);
    return all;
}

/// What the cells keep of their faces: those that look up from the top of their column, all with normal +z.
Surface top_surface(const Scene& scene, const std::array<int, 3>& cell, const Progress* progress) {
    const ResinVolume& volume = *scene.volume;
    const auto& size = volume.size();
    const auto& pitch = volume.pitch_mm();
    const auto nx = static_cast<std::size_t>(size[0]), ny = static_cast<std::size_t>(size[1]);
    std::vector<int> top(nx * ny, -1);
    std::vector<Material> layer(nx * ny);
    std::size_t left = nx * ny;
    for (int z = size[2] - 1; z >= 0 && left > 0; --z) {
        if (progress) progress->check_cancelled();
        volume.copy_box({0, 0, z}, {size[0], size[1], 1}, layer);
        for (std::size_t i = 0; i < layer.size(); ++i)
            if (top[i] < 0 && layer[i] != air) {
                top[i] = z;
                --left;
            }
    }
    Surface out;
    for (int cy = 0; cy * cell[1] < size[1]; ++cy) {
        if (progress) progress->check_cancelled();
        for (int cx = 0; cx * cell[0] < size[0]; ++cx) {
            SurfaceCell c;
            c.first_face = static_cast<std::uint32_t>(out.faces.size());
            std::array<double, 3> centre{};
            for (int y = cy * cell[1]; y < std::min((cy + 1) * cell[1], size[1]); ++y)
                for (int x = cx * cell[0]; x < std::min((cx + 1) * cell[0], size[0]); ++x) {
                    const int z = top[static_cast<std::size_t>(y) * nx + static_cast<std::size_t>(x)];
                    if (z < 0) continue;
                    out.faces.push_back(face_of({x, y, z}, Facing::plus_z, false));
                    centre[0] += pitch[0] * (x + 0.5);
                    centre[1] += pitch[1] * (y + 0.5);
                    centre[2] += pitch[2] * (z + 1);
                    ++c.faces;
                }
            if (c.faces == 0) continue;
            for (std::size_t k = 0; k < 3; ++k) c.centre_mm[k] = static_cast<float>(centre[k] / c.faces);
            c.cell = {cx, cy, static_cast<int>(c.centre_mm[2] / pitch[2] - 0.5) / cell[2]};
            c.normal = {0, 0, 1};
            c.area_mm2 = static_cast<float>(c.faces * pitch[0] * pitch[1]);
            out.cells.push_back(c);
        }
    }
    sort_cells(out);  // where there is relief a row's cells lie on several layers
    return out;
}

}  // namespace

std::array<float, 3> Surface::normal_at(std::size_t cell, std::size_t face) const {
    if (faces[face].slants) return slope[cell];
    const auto facing = static_cast<std::size_t>(faces[face].facing);
    std::array<float, 3> normal{};
    normal[facing / 2] = facing % 2 ? 1.0f : -1.0f;
    return normal;
}

std::array<int, 3> cell_voxels(const std::array<double, 3>& pitch_mm, double cell_mm) {
    std::array<int, 3> voxels{};
    for (std::size_t a = 0; a < 3; ++a) voxels[a] = std::max(1, static_cast<int>(std::lround(cell_mm / pitch_mm[a])));
    return voxels;
}

Surface find_surface(const Scene& scene, const std::array<int, 3>& cell, SurfacePart part, const Progress* progress) {
    VOXTONE_EXPECT(scene.volume && cell[0] >= 1 && cell[1] >= 1 && cell[2] >= 1);
    for (const int voxels : scene.volume->size())
        if (voxels > most_voxels)
            throw ResourceError("a print of " + std::to_string(voxels) + " voxels along an axis has more than the " +
                                std::to_string(most_voxels) +
                                " that its surface is looked for in: predict a part of it");
    Surface surface = part == SurfacePart::top ? top_surface(scene, cell, progress)
                                               : surface_near(scene, cell, {{}, scene.volume->size()}, progress);
    surface.cell_voxels = cell;
    return surface;
}

Surface find_surface_near(const Scene& scene, const std::array<int, 3>& cell, const VoxelBox& box,
                          const Progress* progress) {
    Surface surface = surface_near(scene, cell, box, progress);
    surface.cell_voxels = cell;
    return surface;
}

SeenFrom seen_from(const Surface& surface) {
    double along_z = 0, all = 0;
    for (const SurfaceCell& cell : surface.cells) {
        along_z += static_cast<double>(cell.area_mm2 * std::abs(cell.normal[2]));
        all += static_cast<double>(cell.area_mm2);
    }
    return along_z > 0.9 * all ? SeenFrom::above : SeenFrom::all_sides;
}

Surface part_of(const Surface& surface, std::span<const std::uint32_t> cells) {
    Surface part;
    part.cell_voxels = surface.cell_voxels;
    for (const std::uint32_t i : cells) {
        SurfaceCell cell = surface.cells[i];
        const auto first = static_cast<std::ptrdiff_t>(cell.first_face),
                   last = first + static_cast<std::ptrdiff_t>(cell.faces);
        cell.first_face = static_cast<std::uint32_t>(part.faces.size());
        part.cells.push_back(cell);
        part.faces.insert(part.faces.end(), surface.faces.begin() + first, surface.faces.begin() + last);
        if (!surface.slope.empty()) part.slope.push_back(surface.slope[i]);
    }
    return part;
}

}  // namespace voxtone::optics

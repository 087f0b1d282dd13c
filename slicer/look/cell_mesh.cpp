// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/cell_mesh.h"

#include <algorithm>

#include "base/contracts.h"

namespace voxtone::slicer {

namespace {

constexpr std::int32_t empty = -1, inner = -2;  // of cells that are not of the surface

/// The cells round a corner of the grid: bit a of the index says on which side of it along axis a.
using CellCorner = std::array<std::int32_t, 8>;

/// A face between a solid and an empty cell at a corner: from one of the six edges that meet there to another,
/// counter-clockwise seen from outside.
struct Arc {
    int from, to, owner;
    bool taken = false;
};

int arcs_of(const CellCorner& cells, std::array<Arc, 12>& arcs) {
    int count = 0;
    for (int a = 0; a < 3; ++a) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        for (int side_b = 0; side_b < 2; ++side_b)
            for (int side_c = 0; side_c < 2; ++side_c) {
                const int low = side_b << b | side_c << c, high = low | 1 << a;
                const bool low_solid = cells[std::size_t(low)] != empty, high_solid = cells[std::size_t(high)] != empty;
                if (low_solid == high_solid) continue;
                // e_b x e_c = e_a, which points outward where the lower cell is the solid one.
                const bool forward = (side_b == side_c) == low_solid;
                const int edge_b = 2 * b + side_b, edge_c = 2 * c + side_c;
                arcs[std::size_t(count++)] = {forward ? edge_b : edge_c, forward ? edge_c : edge_b,
                                              low_solid ? low : high};
            }
    }
    return count;
}

/// The cells that a ring of faces passes, without repeats.
struct Polygon {
    std::array<std::int32_t, 12> cell;
    std::size_t size = 0;
    void add(std::int32_t c) {
        if (c >= 0 && (size == 0 || cell[size - 1] != c)) cell[size++] = c;
    }
};

class Mesher {
public:
    Mesher(const optics::ResinVolume& volume, const optics::Surface& surface) : volume_(volume), surface_(surface) {
        for (std::size_t a = 0; a < 3; ++a)
            cells_[a] = (volume.size()[a] + surface.cell_voxels[a] - 1) / surface.cell_voxels[a];
        for (auto& layer : layer_) layer.assign(std::size_t(cells_[0]) * std::size_t(cells_[1]), empty);
        done_.assign(std::size_t(cells_[0] + 1) * std::size_t(cells_[1] + 1), -1);
    }

    std::vector<std::array<std::uint32_t, 3>> run() {
        const auto& cells = surface_.cells;
        std::size_t below = 0, begin = 0;  // cells [below, begin) lie under the plane of corners, [begin, end) on it
        for (int z = 0; z <= cells_[2]; ++z) {
            std::size_t end = begin;
            for (; end < cells.size() && cells[end].cell[2] == z; ++end)
                layer_[1][at(cells[end].cell[0], cells[end].cell[1])] = std::int32_t(end);
            for (std::size_t i = below; i < end; ++i)
                for (int corner = 0; corner < 4; ++corner)
                    visit(cells[i].cell[0] + (corner & 1), cells[i].cell[1] + (corner >> 1), z);
            for (std::size_t i = below; i < begin; ++i) layer_[0][at(cells[i].cell[0], cells[i].cell[1])] = empty;
            std::swap(layer_[0], layer_[1]);
            below = begin;
            begin = end;
        }
        VOXTONE_ENSURE(begin == cells.size());
        return std::move(triangles_);
    }

private:
    [[nodiscard]] std::size_t at(int x, int y) const {
        return std::size_t(y) * std::size_t(cells_[0]) + std::size_t(x);
    }

    /// The cell on the lower (0) or upper (1) side of corner plane z.
    [[nodiscard]] std::int32_t cell(int x, int y, int z, int side) const {
        if (x < 0 || y < 0 || x >= cells_[0] || y >= cells_[1] || z + side < 1 || z + side > cells_[2]) return empty;
        const std::int32_t known = layer_[std::size_t(side)][at(x, y)];
        if (known >= 0) return known;
        // A cell that holds both has a face between them and is of the surface; so one voxel speaks for all.
        const auto& size = surface_.cell_voxels;
        return volume_.at(x * size[0], y * size[1], (z - 1 + side) * size[2]) == optics::air ? empty : inner;
    }

    void visit(int x, int y, int z) {
        int& done = done_[std::size_t(y) * std::size_t(cells_[0] + 1) + std::size_t(x)];
        if (done == z) return;
        done = z;
        CellCorner corner;
        for (int i = 0; i < 8; ++i) corner[std::size_t(i)] = cell(x - 1 + (i & 1), y - 1 + (i >> 1 & 1), z, i >> 2);
        std::array<Arc, 12> arcs;
        const int count = arcs_of(corner, arcs);
        for (int first = 0; first < count; ++first) {
            if (arcs[std::size_t(first)].taken) continue;
            Polygon polygon;
            for (int next = first; next >= 0;) {
                Arc& arc = arcs[std::size_t(next)];
                arc.taken = true;
                polygon.add(corner[std::size_t(arc.owner)]);
                next = -1;
                for (int i = 0; i < count; ++i) {
                    const Arc& other = arcs[std::size_t(i)];
                    if (!other.taken && other.from == arc.to && (next < 0 || other.owner == arc.owner)) next = i;
                }
            }
            add(polygon);
        }
    }

    void add(Polygon& polygon) {
        while (polygon.size > 1 && polygon.cell[polygon.size - 1] == polygon.cell[0]) --polygon.size;
        if (polygon.size < 3) return;
        const auto distance2 = [&](std::size_t i, std::size_t j) {
            const auto &p = surface_.cells[std::size_t(polygon.cell[i])].centre_mm,
                       &q = surface_.cells[std::size_t(polygon.cell[j])].centre_mm;
            return (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]);
        };
        // Quadrilaterals are cut along the shorter diagonal.
        const std::size_t start = polygon.size == 4 && distance2(1, 3) < distance2(0, 2) ? 1 : 0;
        for (std::size_t i = 1; i + 1 < polygon.size; ++i) {
            const std::array<std::uint32_t, 3> t{std::uint32_t(polygon.cell[start]),
                                                 std::uint32_t(polygon.cell[(start + i) % polygon.size]),
                                                 std::uint32_t(polygon.cell[(start + i + 1) % polygon.size])};
            if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles_.push_back(t);
        }
    }

    const optics::ResinVolume& volume_;
    const optics::Surface& surface_;
    std::array<int, 3> cells_{};
    std::array<std::vector<std::int32_t>, 2>
        layer_;              ///< surface cell at a place, or `empty`: below and above the corners
    std::vector<int> done_;  ///< the plane in which a corner was looked at last
    std::vector<std::array<std::uint32_t, 3>> triangles_;
};

}  // namespace

std::vector<std::array<std::uint32_t, 3>> cell_triangles(const optics::ResinVolume& volume,
                                                         const optics::Surface& surface) {
    return Mesher(volume, surface).run();
}

}  // namespace voxtone::slicer

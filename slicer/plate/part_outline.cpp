// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/part_outline.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "slicer/solid/solid.h"

namespace voxtone::slicer {

int cells_above(double mm) { return static_cast<int>(std::ceil(mm / nest_cell_mm - 1e-9)); }
int cells_within(double mm) { return static_cast<int>(std::floor(mm / nest_cell_mm + 1e-9)); }

Outline empty_outline(const VoxelGrid& grid) {
    return {std::max(1, cells_above(grid.size[0] * grid.pitch_mm.x())),
            std::max(1, cells_above(grid.size[1] * grid.pitch_mm.y()))};
}

void take_voxels(Outline& outline, const VoxelGrid& grid, int j, int begin, int end) {
    // Cells that voxels [first, last) of an axis reach into.
    const auto cells = [](int first, int last, double pitch_mm, int most) {
        return std::pair{static_cast<int>(first * pitch_mm / nest_cell_mm),
                         std::min(most - 1, static_cast<int>(last * pitch_mm / nest_cell_mm - 1e-9))};
    };
    const auto [y_low, y_high] = cells(j, j + 1, grid.pitch_mm.y(), outline.height());
    const auto [x_low, x_high] = cells(begin, end, grid.pitch_mm.x(), outline.width());
    for (int y = y_low; y <= y_high; ++y)
        for (int x = x_low; x <= x_high; ++x) outline.set(x, y);
}

Outline outline_of(const JobBody& body) {
    const VoxelGrid& grid = body.grid;
    Outline outline = empty_outline(grid);
    const Solid solid(*body.solid, grid, body.relief);
    constexpr int layers_at_once = 16;
    SpanSlab spans;
    for (int first = 0; first < grid.size[2]; first += layers_at_once) {
        const int last = std::min(first + layers_at_once, grid.size[2]);
        solid.slab(first, last, spans);
        for (int k = first; k < last; ++k)
            for (int j = 0; j < grid.size[1]; ++j)
                for (const Span& span : spans.row(j, k)) take_voxels(outline, grid, j, span.begin, span.end);
    }
    return outline;
}

std::uint64_t voxels_of(const JobBody& body) {
    const Solid solid(*body.solid, body.grid, body.relief);
    constexpr int layers_at_once = 16;
    std::uint64_t voxels = 0;
    SpanSlab spans;
    for (int first = 0; first < body.grid.size[2]; first += layers_at_once) {
        const int last = std::min(first + layers_at_once, body.grid.size[2]);
        solid.slab(first, last, spans);
        for (int k = first; k < last; ++k) voxels += spans.voxels_of_layer(k);
    }
    return voxels;
}

void take_at(Outline& plate, const Outline& outline, double x_mm, double y_mm) {
    const int left = static_cast<int>(std::floor(x_mm / nest_cell_mm)),
              front = static_cast<int>(std::floor(y_mm / nest_cell_mm));
    constexpr int corners = 4;  // of the cells that a cell may lie over
    for (int x = 0; x < outline.width(); ++x)
        for (int y = 0; y < outline.height(); ++y)
            for (int more = 0; more < corners && outline.at(x, y); ++more) {
                const int column = left + x + more % 2, row = front + y + more / 2;
                if (column >= 0 && row >= 0 && column < plate.width() && row < plate.height()) plate.set(column, row);
            }
}

}  // namespace voxtone::slicer

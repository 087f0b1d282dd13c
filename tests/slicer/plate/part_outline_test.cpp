// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/part_outline.h"

#include <catch2/catch.hpp>

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

/// Whether the two hold the same cells.
bool are_same(const Outline& a, const Outline& b) {
    if (a.width() != b.width() || a.height() != b.height()) return false;
    for (int x = 0; x < a.width(); ++x)
        for (int y = 0; y < a.height(); ++y)
            if (a.at(x, y) != b.at(x, y)) return false;
    return true;
}

}  // namespace

TEST_CASE("Lengths in cells are rounded to the safe side, and those that are whole stay") {
    CHECK(cells_above(0.5) == 1);
    CHECK(cells_above(1.0) == 2);
    CHECK(cells_above(1.01) == 3);
    CHECK(cells_within(1.0) == 2);
    CHECK(cells_within(0.99) == 1);
    CHECK(cells_within(0.5 - 1e-12) == 1);  // but for rounding
    CHECK(cells_above(0.5 + 1e-12) == 1);
}

TEST_CASE("An outline holds every cell that a part reaches into, wherever its corner lies") {
    // An L of three cells, whose area is known: each point of it, moved, must lie in a cell that is taken.
    Outline part(2, 2);
    part.set(0, 0), part.set(1, 0), part.set(0, 1);
    constexpr int size = 8, samples = 20;
    for (const double x_mm : {0.0, 0.05, 0.25, 0.45, 1.0, 1.3, 1.45})
        for (const double y_mm : {0.0, 0.05, 0.25, 0.45, 0.5, 1.45}) {
            CAPTURE(x_mm, y_mm);
            Outline plate(size, size), least(size, size);
            take_at(plate, part, x_mm, y_mm);
            for (int i = 0; i < 2 * samples; ++i)
                for (int j = 0; j < 2 * samples; ++j) {
                    if (!part.at(i / samples, j / samples)) continue;
                    const double x = x_mm + (i + 0.5) * nest_cell_mm / samples;
                    const double y = y_mm + (j + 0.5) * nest_cell_mm / samples;
                    least.set(static_cast<int>(x / nest_cell_mm), static_cast<int>(y / nest_cell_mm));
                }
            bool holds = true;
            for (int x = 0; x < size; ++x)
                for (int y = 0; y < size; ++y) holds = holds && (plate.at(x, y) || !least.at(x, y));
            CHECK(holds);
            // And none that it does not come near: one cell more to the right and behind at most.
            Outline most(size, size);
            const int left = cells_within(x_mm), front = cells_within(y_mm);
            for (int x = 0; x < 2; ++x)
                for (int y = 0; y < 2; ++y)
                    for (int more = 0; more < 4 && part.at(x, y); ++more)
                        most.set(left + x + more % 2, front + y + more / 2);
            CHECK(are_same(plate, most));
        }
}

TEST_CASE("What of a part lies beyond the plate is left out") {
    Outline part(2, 2);
    for (int x = 0; x < 2; ++x)
        for (int y = 0; y < 2; ++y) part.set(x, y);
    for (const double mm : {-10.0, -1.51, 1.5, 10.0}) {
        Outline plate(3, 3);
        take_at(plate, part, mm, 0);
        take_at(plate, part, 0, mm);
        CHECK(plate.area() == 0);
    }
    Outline corner(3, 3);
    take_at(corner, part, -0.75, 1.25);  // cells -2 to 0, and 2 to 4
    CHECK(corner.area() == 1);
    CHECK(corner.at(0, 2));
}

TEST_CASE("Voxels take the cells that they reach into") {
    VoxelGrid grid;
    grid.size = {25, 10, 1};
    grid.pitch_mm = {0.1, 0.2, 0.03};
    Outline outline = empty_outline(grid);
    CHECK(outline.width() == 5);
    CHECK(outline.height() == 4);
    take_voxels(outline, grid, 0, 0, 5);  // 0 to 0.5 mm, 0 to 0.2 mm: a cell, and not the one that begins there
    CHECK(outline.area() == 1);
    CHECK(outline.at(0, 0));
    take_voxels(outline, grid, 2, 5, 11);  // 0.5 to 1.1 mm, 0.4 to 0.6 mm: over both borders
    CHECK(outline.area() == 5);
    for (const int x : {1, 2})
        for (const int y : {0, 1}) CHECK(outline.at(x, y));
    take_voxels(outline, grid, 9, 24, 25);  // the last voxel, in the last cell
    CHECK(outline.at(4, 3));
    CHECK(outline.area() == 6);
}

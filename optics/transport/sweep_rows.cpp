// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/sweep_rows.h"

#include <algorithm>
#include <limits>

namespace voxtone::optics {

namespace {

/// The rows of one plane, in their order along y.
struct Plane {
    std::size_t first = 0, count = 0;
};

const GridBlock& block_of(const ViewingGrid& grid, std::size_t row) {
    return grid.transport_block(grid.transport_rows[row]);
}

std::vector<Plane> planes_of(const ViewingGrid& grid, bool down) {
    std::vector<Plane> planes;
    const std::size_t rows = grid.transport_rows.size() - 1;
    for (std::size_t row = 0; row < rows; ++row) {
        if (row == 0 || block_of(grid, row).at[2] != block_of(grid, row - 1).at[2]) planes.push_back({row, 0});
        ++planes.back().count;
    }
    if (down) std::reverse(planes.begin(), planes.end());
    return planes;
}

std::uint32_t task_of(std::size_t row, std::size_t back) { return static_cast<std::uint32_t>(2 * row + back); }

}  // namespace

double SweepRows::at_once() const {
    std::vector<std::uint32_t> way(serial.size(), 1);
    std::uint32_t longest = 1;
    for (const std::uint32_t task : serial)  // all that a task waits for stand before it
        for (const std::uint32_t next : followers[task]) {
            way[next] = std::max(way[next], way[task] + 1);
            longest = std::max(longest, way[next]);
        }
    return double(serial.size()) / longest;
}

SweepRows sweep_rows(const ViewingGrid& grid, bool down, std::size_t fronts) {
    SweepRows made;
    if (grid.transport_rows.size() < 2) return made;
    const std::size_t rows = grid.transport_rows.size() - 1;
    const std::vector<Plane> planes = planes_of(grid, down);
    made.fronts = std::clamp<std::size_t>(fronts, 1, planes.size());
    made.followers.resize(2 * rows);
    made.front.resize(rows);
    made.serial.reserve(2 * rows);
    constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
    std::vector<std::size_t> last_at(static_cast<std::size_t>(grid.lattice[1]), none);  // by y: the row crossed last
    for (std::size_t p = 0; p < planes.size(); ++p) {
        const auto [first, count] = planes[p];
        for (std::size_t back = 0; back < 2; ++back)
            for (std::size_t k = 0; k < count; ++k)
                made.serial.push_back(task_of(back ? first + count - 1 - k : first + k, back));
        for (std::size_t row = first; row < first + count; ++row) {
            made.front[row] = static_cast<std::uint32_t>(p % made.fronts);
            const bool is_last = row + 1 == first + count;
            if (!is_last) {
                made.followers[task_of(row, 0)].add(task_of(row + 1, 0));
                made.followers[task_of(row + 1, 1)].add(task_of(row, 1));
            }
            made.followers[task_of(row, 0)].add(task_of(row, 1));
            std::size_t& last = last_at[static_cast<std::size_t>(block_of(grid, row).at[1])];
            for (std::size_t back = 0; last != none && back < 2; ++back)
                made.followers[task_of(last, back)].add(task_of(row, back));
            last = row;
        }
        if (p < made.fronts) continue;
        const auto [old_first, old_count] = planes[p - made.fronts];
        made.followers[task_of(old_first + old_count - 1, 0)].add(task_of(first, 0));
        made.followers[task_of(old_first, 1)].add(task_of(first + count - 1, 1));
    }
    return made;
}

}  // namespace voxtone::optics

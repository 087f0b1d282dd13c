// SPDX-License-Identifier: GPL-3.0-or-later
//
// The order in which a sweep crosses the rows of blocks of a grid, as tasks: planes of blocks one behind the other
// along z, rows of a plane along y, first with y (octants 0 and 1), then against it (2 and 3). One after the other in
// the order of `serial` they make the same as all at once by `followers` (a wave front through the rows, as Koch, Baker
// and Alcouffe 1992, "Solution of the first-order form of the 3-D discrete ordinates equation on a massively parallel
// processor", Trans. Am. Nucl. Soc. 65): a task waits for
//   - the row before it in its plane and the same row of the plane before it, whose light it takes;
//   - where it runs against y, its own row with y, so that the moments of a cell are added up in one order;
//   - where it is its plane's first, the last of the plane whose front it takes over: only so many planes are crossed
//     at once as there is room for their fronts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "optics/grid/viewing_grid.h"

namespace voxtone::optics {

/// At most four; those of a task that has fewer stand first.
class RowFollowers {
public:
    void add(std::uint32_t task) { tasks_[count_++] = task; }
    [[nodiscard]] const std::uint32_t* begin() const { return tasks_; }
    [[nodiscard]] const std::uint32_t* end() const { return tasks_ + count_; }

private:
    std::uint32_t tasks_[4]{};
    std::uint32_t count_ = 0;
};

struct SweepRows {
    /// Task 2 r + back is row r of the grid, against y where `back` is 1.
    std::vector<std::uint32_t> serial;
    std::vector<RowFollowers> followers;  ///< by task
    std::vector<std::uint32_t> front;     ///< by row: its plane's front, below `fronts`
    std::size_t fronts = 1;

    /// Tasks divided by those of the longest way through them: how many there are to do at once, on average.
    [[nodiscard]] double at_once() const;
};

/// body(row, back) of all: one after the other, or at once where there are several fronts.
template <class Body>
void cross_rows(const SweepRows& rows, Body&& body) {
    const auto cross = [&](std::uint32_t task) { body(std::size_t{task / 2}, std::size_t{task % 2}); };
    if (rows.fronts > 1)
        parallel_graph(std::span<const RowFollowers>(rows.followers), cross);
    else
        for (const std::uint32_t task : rows.serial) cross(task);
}

/// Of light that runs up, or down. `fronts`: planes that may be crossed at once, at least 1.
[[nodiscard]] SweepRows sweep_rows(const ViewingGrid& grid, bool down, std::size_t fronts);

}  // namespace voxtone::optics

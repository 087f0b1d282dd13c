// SPDX-License-Identifier: GPL-3.0-or-later
//
// The white twin of a flat slab, with little noise from few paths.
//
// The appearance of a box all of white falls towards its sides, smoothly, and has the symmetry of the box. So the
// traced values are averaged over the four mirrored places (where the cells divide the box), and then over a window
// around each cell that reaches a quarter of the way to the nearer border, along x and y apart, and no further than 1.5
// mm. A window is symmetric about its cell: what falls linearly stays as it is; at the border itself nothing is
// averaged across it.
#pragma once

#include <cstddef>
#include <vector>

namespace voxtone::loop_benchmark {

/// value[(row * columns + column) * channels + channel], in place. `mirrored_x`, `_y`: the box has whole cells there.
void smooth_flat_white(std::vector<float>& value, std::size_t columns, std::size_t rows, std::size_t channels,
                       double cell_mm, bool mirrored_x, bool mirrored_y);

}  // namespace voxtone::loop_benchmark

// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/optics/transport/optical_grid.h"

namespace voxtone::optics {

std::size_t OpticalGrid::memory_bytes() const {
    const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
    return of(blocks) + of(block_at) + of(transport_rows) + of(transport_blocks) + of(medium) + of(outer) +
           of(face_of_cell) + of(faces) + of(laws) + of(law);
}

}  // namespace voxtone::optics

// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a prediction costs: flat slabs with a coloured skin of 0.486 mm over white, 3.24 mm in all, of growing size.
#pragma once

#include <vector>

#include "optics/transport/transport.h"

namespace voxtone::accuracy {

struct Cost {
    double area_mm2 = 0;
    std::size_t optical_cells = 0, voxels = 0;
    double core_seconds = 0;  ///< of the process, all threads
    double bytes_per_cell = 0;
    optics::TransportSummary summary;
};

/// A slab that has about this many cells of transport.
[[nodiscard]] Cost price_of_slab(const optics::TransportOptions& options, double optical_cells);

}  // namespace voxtone::accuracy

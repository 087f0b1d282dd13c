// SPDX-License-Identifier: GPL-3.0-or-later
//
// What all channels of a grid have in common: made once, never changed.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "optics/grid/viewing_grid.h"
#include "optics/transport/sweep_rows.h"

namespace voxtone::optics {

struct TransportParameters {
    explicit TransportParameters(const ViewingGrid& of);

    struct FaceSums {
        float weight = 0, through = 0;  ///< sum w |Omega . e| (t): of the four octants
    };
    /// What leaves through an outer face in a furnace.
    [[nodiscard]] float furnace_flux(std::size_t face) const {
        return sums[grid.law[face]].through * grid.faces[face].area_mm2;
    }
    [[nodiscard]] std::size_t axis_of(std::size_t face) const {
        return static_cast<std::size_t>(grid.faces[face].facing) / 2;
    }

    const ViewingGrid& grid;
    std::array<float, 3> edge{};  ///< of a cell, mm
    float volume = 0;
    std::array<Octet, 3> flux_weight{};  ///< w |Omega_a|
    std::vector<FaceSums> sums;          ///< per law
    /// phi / J into a black sheet; 1 / T (sheet_way.h).
    float sheet_way = 0, sheet_T_inverse = 0;
    std::array<SweepRows, 2> rows;  ///< of light that runs up, and down
};

}  // namespace voxtone::optics

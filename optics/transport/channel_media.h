// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the media of one channel are to diffusion, to sweeps and at faces: made once for a solve.
#pragma once

#include <cstddef>
#include <vector>

#include "optics/transport/transport_medium.h"
#include "optics/transport/transport_parameters.h"
#include "optics/transport/transport_sweep.h"

namespace voxtone::optics {

/// Weight of the differences (transport_sweep.h): on cells as thick as these an edge would show ripples with 1; of 1,
/// 0.85 and 0.7 this one is nearest to Monte Carlo on kodim23 (`predictor_accuracy --fine 0 compare`).
inline constexpr double viewing_theta = 0.85;

/// And on parts of them, thin enough to follow an edge.
inline constexpr double fine_theta = 1;

/// Of a grid's mixtures and of core blocks, by material; index 0 is air.
struct GridMedia {
    std::vector<TransportMedium> cells, core;
    std::vector<TransportMedium> parts;  ///< of the fine cells, as FineBlocks numbers them
    /// Share of the light that leaves towards a sheet which comes in again: per open face, and per core node. Empty:
    /// all of it from white sheets.
    std::vector<float> sheet, core_sheet;
};

struct ChannelMedia {
    /// Both are to live longer.
    ChannelMedia(const TransportParameters& parameters, const GridMedia& of);

    /// What a cell loses through an outer face per phi, and gets per unit of current that comes in.
    struct Exchange {
        float loss = 0, gain = 0;
    };
    /// What a sheet that is not black sends back through an open face.
    [[nodiscard]] float sent_back(std::size_t face) const {
        return media.sheet.empty() ? 1.0f : media.sheet[parameters.grid.place_of_face[face]];
    }

    const TransportParameters& parameters;
    const GridMedia& media;
    std::vector<float> D, core_D, widened, core_widened, core_sigma_a;  ///< per medium
    std::vector<Exchange> exchange;                                     ///< per face that is not the core's
    std::vector<float> core_loss;                                       ///< per core node
    std::vector<SweepMedium> cell_ways, part_ways;                      ///< per medium

private:
    void fit_core(float widest);
    [[nodiscard]] Exchange exchange_at(std::size_t face) const;
    [[nodiscard]] float loss_of_core(std::size_t core) const;
};

}  // namespace voxtone::optics

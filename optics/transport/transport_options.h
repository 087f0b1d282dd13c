// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the fast predictor (transport.h) can be told, and what it tells of its work.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "optics/grid/block_contrast.h"
#include "optics/numerics/scratch_space.h"

namespace voxtone::optics {

struct TransportOptions {
    /// >= 1. A prediction that stands alone makes so many, and up to twice as many until one changes less than
    /// `first_change`; the first one of a sequence at most so many.
    int sweeps = 3;
    double cell_mm = 0.085;                        ///< viewing cell: what a person resolves at 300 mm
    Refinement refinement = Refinement::contrast;  ///< where they are cut finer
    /// Of Refinement::contrast, in units of L* (refinement.h): blocks of less stay whole. 0: none does.
    double least_contrast = 5;
    double colour_mm = 0.8;  ///< how deep below the surface colour is expected to come and go
    /// What colour lies deeper: of blocks with cells of their own, or, true, of nodes of diffusion that hold the mean
    /// of their blocks (a node for 64 cells). Then grids keep their shape whatever is printed, and a gradient ends
    /// there.
    bool deep_colour_in_nodes = false;
    /// A print that stands alone, the first one of a sequence and its twin are swept no more where the last sweep
    /// changed less of what is seen in a channel: the twin of a cow of 30 mm changed 0.015, 0.003 and 0.001 after one,
    /// two and three; a photograph in its darkest channel 0.51, 0.02, 0.02 and 0.003. 0: always `sweeps`.
    double first_change = 0.005;
    /// Of the later predictions of a sequence, >= 1: the first correction of a print moves more light than two sweeps
    /// carry, and a loop that believes them stops early (docs/decisions/007).
    int next_sweeps = 3;
    /// A later prediction sweeps no more where the last sweep changed less of what is seen in a channel. 0: always
    /// `next_sweeps`.
    double next_change = 0.01;
    /// Of an adjoint, after a step of diffusion, >= 1: they leave 1 to 3 % of it, one 4 to 10 % (docs/decisions/003).
    int adjoint_sweeps = 2;
    std::size_t tile_cells = 250'000;  ///< most surface cells predicted at once (viewing_tiles.h), >= 1
    int tile_halo = 3;                 ///< blocks around a tile that it transports light in, >= 1
    double start_tolerance = 0.05;     ///< of the first diffusion solve
    std::size_t memory_bytes = 0;      ///< most to use; 0: no limit
    /// Where a sequence puts tiles that do not fit into `memory_bytes`; empty: nowhere, and it refuses. Same bits.
    MakeScratch scratch{};
};

/// What a prediction did and took.
struct TransportSummary {
    std::size_t cells = 0;  ///< viewing cells of transport, whole ones
    std::size_t nodes = 0, memory_bytes = 0;
    std::size_t pieces = 0;
    double grid_s = 0, diffusion_s = 0, sweep_s = 0, total_s = 0;
    int diffusion_steps = 0;  ///< of all channels
    /// Per channel: largest change of a face's appearance by the last sweep's correction.
    std::vector<double> last_change;
    /// Largest of all channels: sum of those changes / what leaves, both as flux.
    double mean_change = 0;
    int open_solves = 0;  ///< diffusion solves that ended without reaching their tolerance
    /// Values of light that were put into 16 bits to be kept, and those that lost what is seen there (viewing_field.h).
    std::size_t kept_values = 0, clipped_values = 0;
};

/// What a reader of the prediction should know of it: a sentence each, none where all went well: more than one
/// kept value in a thousand clipped, a solve left open, a last sweep that still changed what leaves by more than 2 %.
[[nodiscard]] std::vector<std::string> remarks_of(const TransportSummary& summary);

}  // namespace voxtone::optics

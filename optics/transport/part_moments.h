// SPDX-License-Identifier: GPL-3.0-or-later
//
// The light of blocks that are cut finer (FineBlocks), part by part.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "optics/transport/channel_media.h"
#include "optics/transport/transport_sweep.h"
#include "optics/transport/viewing_diffusion.h"

namespace voxtone::optics {

class PartMoments {
public:
    explicit PartMoments(const TransportParameters& parameters) : parameters_(parameters), grid_(parameters.grid) {}
    /// Of the grid as it is cut now, without light.
    void clear();
    [[nodiscard]] bool has(std::size_t t) const { return grid_.fine.any() && grid_.fine.first[t] != not_fine; }
    /// For a sweep of one half.
    [[nodiscard]] SweepCells cells(const ChannelMedia& media, bool down) {
        return {media.part_ways, now_, down ? down_ : up_, static_cast<float>(fine_theta)};
    }

    /// Adds a correction, linear over each cell of block t.
    void correct(std::size_t t, const ChannelMedia& media, std::span<const float> phi,
                 const ViewingDiffusion::Flows& J);
    /// The parts become the sweep's; each cell of block t gets their mean, and as a source what the sweep changed.
    void take_sweep(std::size_t t, const GridMedia& media, std::span<Moments> cells, std::span<Moments> sources);
    /// What a sweep of whole cells changed, alike in all parts of a cell.
    void take_sweep_of_cells(std::size_t t, std::span<const Moments> up, std::span<const Moments> down,
                             std::span<const Moments> before);
    [[nodiscard]] std::size_t memory_bytes() const;

private:
    /// body(cell, its first part) of the solid cells of a block that is cut.
    template <class Body>
    void each_cell(std::size_t t, Body&& body) const;

    const TransportParameters& parameters_;
    const ViewingGrid& grid_;
    std::vector<Moments> now_, up_, down_;
};

}  // namespace voxtone::optics

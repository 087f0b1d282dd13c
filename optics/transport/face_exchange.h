// SPDX-License-Identifier: GPL-3.0-or-later
//
// Light at the outer faces of cells: what leaves through them and what comes back in, by the laws of
// transport_directions.h, and what passes between cells and the core.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "optics/transport/channel_media.h"
#include "optics/transport/transport_parameters.h"
#include "optics/transport/transport_sweep.h"
#include "optics/transport/viewing_diffusion.h"
#include "optics/transport/viewing_field.h"

namespace voxtone::optics {

/// The light that faces belong to.
struct InnerLight {
    std::span<const Moments> cells;
    std::span<const float> core;  ///< phi of nodes
};

class FaceExchange {
public:
    /// Room for a tile after another: what it holds does not matter.
    struct Workspace {
        std::vector<Octet> in, out;
        std::vector<float> flux, flux_change;
        [[nodiscard]] std::size_t memory_bytes() const;
    };
    FaceExchange(const TransportParameters& parameters, Workspace room);
    [[nodiscard]] Workspace take_workspace() { return std::move(light_); }

    /// Of a solve where this radiance comes from outside through each open face, in order.
    void begin(std::vector<float> incoming);
    /// No light leaves.
    void clear() { std::ranges::fill(light_.out, Octet{}); }
    /// 1 through each face to the light.
    [[nodiscard]] std::vector<float> light_from_everywhere() const;
    [[nodiscard]] float incoming(std::size_t face) const { return incoming_[parameters_.grid.place_of_face[face]]; }

    void load(std::span<const ViewingField::FaceCode> from);
    void store(std::vector<ViewingField::FaceCode>& to) const;
    /// The faces send back what they reflect, of what leaves now.
    void reflect(const ChannelMedia& media, const InnerLight& light);
    /// Adds, per cell, what the surface will send back more than it did.
    void add_sources(const ChannelMedia& media, std::span<float> to) const;
    /// Adds phi and J of a correction, linear over each cell of a block, to what leaves through its faces, and finds
    /// their fluxes.
    void correct(std::size_t t, const ChannelMedia& media, std::span<const float> phi_of_cell,
                 const ViewingDiffusion::Flows& J);
    /// From memory, while the block before is worked at: faces that lie side by side have laws that do not.
    void prefetch_laws(std::size_t t) const;

    [[nodiscard]] std::span<const Octet> in() const { return light_.in; }
    [[nodiscard]] std::span<Octet> out() { return light_.out; }
    [[nodiscard]] std::span<const std::array<float, 2>> core_in() const { return core_in_; }
    [[nodiscard]] std::span<float> core_out() { return core_out_; }
    /// What leaves through each outer face, and how much of it the last correction made.
    [[nodiscard]] std::span<const float> flux() const { return light_.flux; }
    /// Largest change of the appearance of a face to the light by it.
    [[nodiscard]] double last_change() const;
    /// Sum of its changes through faces to the light / of the fluxes.
    [[nodiscard]] double relative_change() const;
    [[nodiscard]] std::size_t memory_bytes() const;

private:
    /// Light that passes the corners of a block's staircase (corner leakage), given back region by region:
    /// [region][octant][direction].
    using Pool = std::array<float, 512>;
    void pool(const GridBlock& block, Pool& pool) const;
    [[nodiscard]] std::array<float, 2> from_core(std::size_t face, const ChannelMedia& media,
                                                 const InnerLight& light) const;
    [[nodiscard]] Octet returned(const Pool& pool, std::size_t face, std::size_t slot, const ChannelMedia& media) const;
    /// body(block, its pool) of each.
    template <class Body>
    void each_pool(Body&& body) const;
    /// body(face) of those to the light.
    template <class Body>
    void each_lit(Body&& body) const;

    const TransportParameters& parameters_;
    const ViewingGrid& grid_;
    Workspace light_;                            ///< [open face * 4 + tangential signs]; per face
    std::vector<float> incoming_;                ///< per open face
    std::vector<std::array<float, 2>> core_in_;  ///< per core face (transport_sweep.h)
    std::vector<float> core_out_;
};

}  // namespace voxtone::optics

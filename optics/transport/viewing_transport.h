// SPDX-License-Identifier: GPL-3.0-or-later
//
// Light in a viewing grid, channel after channel: the iteration of transport.h where cells and nodes of diffusion are
// one. A sweep of discrete ordinates (transport_sweep.h), then what it changed spread by diffusion (diffusion synthetic
// acceleration), and again.
//
// Keeps nothing of a channel but what the caller holds for it, a field: phi and J of each cell, phi of the core nodes
// and what leaves through each face (viewing_field.h). A field of other resins is as good a start as the resins
// are alike.
//
// Memory besides the grid and the fields: 64 bytes a cell (moments before and after a sweep, of light that runs up and
// down; the equations of the corrections), 256 a face to the light, and that of ViewingDiffusion.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "base/progress.h"
#include "optics/transport/channel_media.h"
#include "optics/transport/face_exchange.h"
#include "optics/transport/part_moments.h"
#include "optics/transport/sweep_scratch.h"
#include "optics/transport/transport_options.h"
#include "optics/transport/viewing_diffusion.h"
#include "optics/transport/viewing_field.h"

namespace voxtone::optics {

class ViewingTransport {
public:
    /// The memory that a tile after another works in, so that it need not be asked for and cleared again each time:
    /// what it holds does not matter.
    struct Workspace {
        std::vector<Moments> moments;
        SweepScratch scratch;
        FaceExchange::Workspace faces;
        [[nodiscard]] std::size_t memory_bytes() const;
    };
    /// `start_tolerance`: of a first diffusion solve (TransportOptions).
    ViewingTransport(const ViewingGrid& grid, double start_tolerance, Workspace room = {});
    ViewingTransport(const ViewingTransport&) = delete;
    ViewingTransport& operator=(const ViewingTransport&) = delete;
    /// For the next one; this one is of no use then.
    [[nodiscard]] Workspace take_workspace();
    /// A fine cell: its light three times, what it holds twice while blocks are filled.
    static constexpr std::size_t bytes_of_part = 3 * sizeof(Moments) + 10;
    /// What it will take about, with fields of so many channels, besides fine cells.
    [[nodiscard]] static std::size_t bytes_for(const ViewingGrid& grid, std::size_t channels);

    struct Sweeps {
        int least = 0, most = 0;
        double enough = 0;  ///< no more after one that changed less of what leaves, once `least` are made
    };
    /// Light 1 comes in through each outer face to the light. Starts from `field`, or with a diffusion solve where it
    /// is empty; leaves the new field there. `ghost_phi`: phi of the grid's ghosts; nothing given: they take that of
    /// their neighbours, as if the cut were a mirror. Unless `least` is 1 the first sweep crosses whole cells, of which
    /// there are fewer than parts (docs/decisions/022). Throws Cancelled: `progress` is asked many times a second.
    void solve(const GridMedia& media, ViewingField& field, Sweeps sweeps, TransportSummary& summary,
               const Progress* progress, std::span<const float> ghost_phi = {});
    /// `light`: radiance that comes in through each outer face to the light, of any sign: a function's d F / d flux.
    /// Starts with a step of a diffusion solve; a cut is a mirror. Contract: whole cells.
    void solve_adjoint(const GridMedia& media, std::span<const float> light, int sweeps, TransportSummary& summary,
                       const Progress* progress);
    /// After `solve_adjoint`, whose media live still: d F / d sigma_t and d F / d sigma_s of each cell's
    /// TransportMedium, from `forward`, the field of light 1 in the same media (viewing_gradient.h). Holds that light
    /// afterwards.
    void derivatives(const ViewingField& forward, std::span<float> by_sigma_t, std::span<float> by_sigma_s,
                     const Progress* progress = nullptr);
    /// What leaves through each outer face, in units in which a furnace gives `furnace_flux`.
    [[nodiscard]] std::span<const float> flux() const { return faces_.flux(); }
    [[nodiscard]] float furnace_flux(std::size_t face) const { return parameters_.furnace_flux(face); }
    /// phi of a cell, after `solve`.
    [[nodiscard]] float phi(std::size_t cell) const { return moments_[cell].phi; }
    /// Mean phi of a block's solid cells, or of its node, after `solve`.
    [[nodiscard]] float mean_phi(const GridBlock& block) const;
    /// Of the last sweep and correction (face_exchange.h).
    [[nodiscard]] double last_change() const { return faces_.last_change(); }
    [[nodiscard]] double relative_change() const { return faces_.relative_change(); }
    [[nodiscard]] std::size_t memory_bytes() const;

private:
    class Solve;
    void load(const ViewingField& field, std::span<const float> ghost_phi);
    void store(ViewingField& field, TransportSummary& summary) const;

    const ViewingGrid& grid_;
    const TransportParameters parameters_;
    const double start_tolerance_;
    ViewingDiffusion diffusion_;
    FaceExchange faces_;
    PartMoments parts_;
    std::vector<Moments> moments_;  ///< per cell: phi and J; the mean of its parts
    SweepScratch scratch_;
    std::vector<float> core_phi_, core_x_, core_right_, core_p_, core_z_;
    std::optional<ChannelMedia> channel_;  ///< of the last solve
};

}  // namespace voxtone::optics

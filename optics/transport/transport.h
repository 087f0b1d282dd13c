// SPDX-License-Identifier: GPL-3.0-or-later
//
// The fast predictor: deterministic light transport through the voxels, no training, valid for any resins.
//
//   Omega . grad psi + sigma_t psi = sigma_s (phi + 3 g' Omega . J),   phi = <psi>, J = <Omega psi>
//
// Method. A multigrid diffusion solve of the whole body gives a first phi and J. Then a few sweeps of discrete
// ordinates (64 directions, diamond differences, transport_sweep.h) through cells of one voxel in the coloured skin and
// of one viewing cell in a margin below it; deeper, in the core, the light is diffuse and stays with diffusion. After
// each sweep a diffusion solve for the scattering source that the sweep left over corrects phi everywhere (diffusion
// synthetic acceleration: Larsen 1984; Adams and Larsen 2002), so that 4 sweeps converge although white scatters
// hundreds of times. The refractive surface reflects by mirror images of directions (transport_directions.h); media
// carry the albedo that makes homogeneous half-spaces exact (transport_medium.h).
//
// Sequences. With `viewing_cells` everything is predicted on viewing cells and the light is kept from one prediction to
// the next, for loops: viewing_sequence.h.
//
// Pieces. A body too large for the memory allowed is cut into boxes. For each the whole body is solved, but with
// transport cells only in the box and a halo around it and with diffusion on a few nodes per block elsewhere, so that
// white still carries light over any distance. What the halo leaves of the difference is stated in docs/predict.md.
//
// Gradient: the operator is its own adjoint under reversal of directions, so the adjoint is one more solve, lit through
// the surface by d(function)/d(appearance).
//
// Units mm, mm^-1. Range: any resins, any g in (-1, 1), eta >= 1. Errors against Monte Carlo: docs/predict.md. What it
// cannot see: shadows and second bounces outside the body; sharp caustics in clear resin (64 directions).
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "voxtone/optics/scene/appearance_model.h"
#include "voxtone/optics/transport/optical_grid.h"

namespace voxtone::optics {

struct TransportOptions {
    int sweeps = 3;              ///< >= 1
    double cell_mm = 0.085;      ///< viewing cell: sets the cells of the margin and of diffusion
    bool voxel_skin = true;      ///< skin cells of one voxel; false: of one viewing cell
    bool viewing_cells = false;  ///< the whole prediction on viewing cells (viewing_sequence.h), ten times as fast
    double colour_mm = 0.8;      ///< with them: how deep below the surface colour is expected to come and go
    int next_sweeps = 2;         ///< with them: of the later predictions of a sequence, >= 1
    double next_change =
        0.01;  ///< with them: a later prediction sweeps no more where the last sweep changed less of what is
               ///< seen in a channel; of its adjoint ten times as much. 0: always `next_sweeps`
    std::size_t tile_cells =
        250'000;                ///< with them: most surface cells that are predicted at once (viewing_tiles.h), >= 1
    int tile_halo = 3;          ///< with them: blocks around a tile that it transports light in, >= 1
    double finest_mm = 0.0425;  ///< skin voxels are cut along axes where they are longer; 0: never
    int margin_blocks = 2;      ///< rings of 4 viewing cells of transport below the skin, >= 0
    double start_tolerance = 0.05;      ///< of the first diffusion solve
    double correction_tolerance = 0.3;  ///< of those after each sweep
    double ease = 0.55;            ///< keeps the corrections stable: viewing cells added to D per optical depth of one
    double piece_mm = 0;           ///< edge of the pieces that a body is predicted in; 0: as large as memory allows
    double halo_mm = 5;            ///< how far around a piece light is transported in full; diffusion beyond
    std::size_t memory_bytes = 0;  ///< most to use; 0: no limit
};

/// What a prediction did and took.
struct TransportSummary {
    std::size_t skin_cells = 0, margin_cells = 0, nodes = 0, memory_bytes = 0;
    std::size_t pieces = 0;
    double grid_s = 0, diffusion_s = 0, sweep_s = 0, total_s = 0;
    int diffusion_steps = 0;  ///< of all channels
    std::vector<double>
        last_change;  ///< per channel: largest change of a face's appearance by the last sweep's correction
};

/// Derivative of a function of the appearance with respect to the resin fractions of every transport cell, all
/// fractions taken as free (a change that keeps their sum is a difference of two entries).
struct TransportGradient {
    std::shared_ptr<const OpticalGrid> grid;
    std::size_t resins = 0;
    std::vector<float> by_fraction;     ///< [cell * resins + resin]; cells as in `grid`
    std::array<int, 3> split{1, 1, 1};  ///< pieces that a voxel was cut into
    /// 0 for air and for the core, whose cells are no transport cells.
    [[nodiscard]] float at(const std::array<int, 3>& voxel, std::size_t resin) const;
};

class TransportPredictor final : public AppearanceModel {
public:
    explicit TransportPredictor(const TransportOptions& options = {});

    [[nodiscard]] Appearance predict(const Scene& scene, const Surface& surface,
                                     const Progress* progress = nullptr) const override;
    [[nodiscard]] Appearance predict(const Scene& scene, const Surface& surface, TransportSummary& summary,
                                     const Progress* progress = nullptr) const;
    /// With `viewing_cells` a ViewingSequence, where memory allows.
    [[nodiscard]] std::unique_ptr<AppearanceSequence> sequence(const Scene& scene,
                                                               const Surface& surface) const override;

    /// The appearance, and the gradient of a function F of it: `derivative` is handed the appearance and fills in
    /// d F / d value (same shape). Costs the prediction, one adjoint solve and two more sweeps a channel.
    using Derivative = std::function<void(const Appearance&, std::span<float>)>;
    [[nodiscard]] Appearance predict(const Scene& scene, const Surface& surface, const Derivative& derivative,
                                     TransportGradient& gradient, TransportSummary& summary,
                                     const Progress* progress = nullptr) const;

private:
    struct Window;
    [[nodiscard]] std::vector<Window> pieces(const Scene& scene) const;
    [[nodiscard]] Appearance solve(const Scene& scene, const Surface& surface, const Window& window,
                                   const Derivative* derivative, TransportGradient* gradient, TransportSummary& summary,
                                   const Progress* progress) const;
    TransportOptions options_;
};

}  // namespace voxtone::optics

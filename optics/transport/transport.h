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
// synthetic acceleration: Larsen 1984; Adams and Larsen 2002), so that 3 sweeps are enough although white scatters
// hundreds of times. The refractive surface reflects by mirror images of directions (transport_directions.h); media
// carry the albedo that makes homogeneous half-spaces that look along z exact (transport_medium.h); where a cell or
// block holds several resins, they are those of the halftone (effective_medium.h).
//
// Sequences. With `viewing_cells` everything is predicted on viewing cells and the light is kept from one prediction to
// the next, for loops: viewing_sequence.h.
//
// Jobs predict with `viewing_cells` and Refinement::contrast: cells of the eye, cut into voxels where light enters and
// resins meet (coarse/refinement.h), in tiles as large as memory allows. What does not fit into the memory allowed on
// voxels is predicted so, too. Errors: docs/predict.md.
//
// Gradient: the operator is its own adjoint under reversal of directions, so the adjoint is one more solve, lit through
// the surface by d(function)/d(appearance). No part of a job asks for it, loops take that of viewing cells
// (viewing_gradient.h): it is exact direction by direction, and the tests hold it to differences of predictions.
//
// What went less than well (light clipped, solves left open) is said in Appearance::remarks.
//
// Units mm, mm^-1. Range: any resins, any g in (-1, 1), eta >= 1; tested at g = -0.3, 0, 0.4, 0.7 and eta = 1, 1.33,
// 1.5 (tests/optics/transport/phase_range_test.cpp). Errors against Monte Carlo: docs/predict.md. What it
// cannot see: shadows and second bounces outside the body; sharp caustics in clear resin (64 directions).
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "voxtone/optics/media/effective_medium.h"
#include "voxtone/optics/scene/appearance_model.h"
#include "voxtone/optics/transport/optical_grid.h"
#include "voxtone/optics/transport/transport_options.h"

namespace voxtone::optics {

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
    /// What a prediction of a body of so many mm^3, in voxels of this pitch, needs at the least: can be told before
    /// there is a volume. It may need much more.
    [[nodiscard]] std::size_t least_bytes(double solid_mm3, const std::array<double, 3>& pitch_mm) const;

    /// With `viewing_cells` a ViewingSequence, where memory allows.
    [[nodiscard]] std::unique_ptr<AppearanceSequence> sequence(const Scene& scene, const Surface& surface,
                                                               const Progress* progress = nullptr) const override;

    /// The appearance, and the gradient of a function F of it: `derivative` is handed the appearance and fills in
    /// d F / d value (same shape). Costs the prediction, one adjoint solve and two more sweeps a channel.
    using Derivative = std::function<void(const Appearance&, std::span<float>)>;
    [[nodiscard]] Appearance predict(const Scene& scene, const Surface& surface, const Derivative& derivative,
                                     TransportGradient& gradient, TransportSummary& summary,
                                     const Progress* progress = nullptr) const;

private:
    [[nodiscard]] std::size_t bytes_of_voxels(const Scene& scene, const Progress* progress) const;
    [[nodiscard]] Appearance solve(const Scene& scene, const Surface& surface, const EffectiveMedium& halftone,
                                   const Derivative* derivative, TransportGradient* gradient, TransportSummary& summary,
                                   const Progress* progress) const;
    TransportOptions options_;
};

}  // namespace voxtone::optics

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The fast predictor: deterministic light transport through the print, no training, valid for any resins.
//
//   Omega . grad psi + sigma_t psi = sigma_s (phi + 3 g' Omega . J),   phi = <psi>, J = <Omega psi>
//
// Method. A multigrid diffusion solve of the whole body gives a first phi and J. Then a few sweeps of discrete
// ordinates (64 directions, diamond differences, transport_sweep.h) through cells of the eye's size near the surface,
// cut into voxels where light enters and resins meet (refinement.h); deeper, in the core, the light is diffuse and
// stays with diffusion. After each sweep a diffusion solve for the scattering source that the sweep left over corrects
// phi everywhere (diffusion synthetic acceleration: Larsen 1984; Adams and Larsen 2002), so that 3 to 6 sweeps are
// enough although white scatters hundreds of times. The refractive surface reflects by mirror images of directions
// (transport_directions.h); media carry the albedo that makes homogeneous half-spaces that look along z exact
// (transport_medium.h); where a cell holds several resins, they are those of the halftone (effective_medium.h).
//
// Large bodies are predicted tile by tile (viewing_tiles.h), in tiles as the options have them. Loops ask for a
// sequence, in which the light of one print is kept for the next (viewing_sequence.h), with its adjoint gradient
// (viewing_gradient.h).
//
// What went less than well (light clipped, solves left open) is said in Appearance::remarks.
//
// Units mm, mm^-1. Range: any resins, any g in (-1, 1), eta >= 1; tested at g = -0.3, 0, 0.4, 0.7 and eta = 1, 1.33,
// 1.5 (tests/optics/transport/phase_range_test.cpp). Errors against Monte Carlo: docs/predict.md. What it
// cannot see: shadows and second bounces outside the body; sharp caustics in clear resin (64 directions).
#pragma once

#include <array>
#include <cstddef>
#include <memory>

#include "optics/scene/appearance_model.h"
#include "optics/transport/transport_options.h"

namespace voxtone::optics {

class TransportPredictor final : public AppearanceModel {
public:
    /// Throws UsageError for less than one sweep and cells of no size.
    explicit TransportPredictor(const TransportOptions& options = {});

    /// Throws ResourceError where a tile does not fit into the memory allowed.
    [[nodiscard]] Appearance predict(const Scene& scene, const Surface& surface,
                                     const Progress* progress = nullptr) const override;
    [[nodiscard]] Appearance predict(const Scene& scene, const Surface& surface, TransportSummary& summary,
                                     const Progress* progress = nullptr) const;
    /// On the body's grid, which has cells deeper down than a twin of one resin needs: the twin differs from a
    /// prediction of it alone, by 8e-5 rms on a sphere of 6 mm (tests/optics/transport/viewing_sequence_test.cpp).
    [[nodiscard]] TwinAppearances predict_with_twin(const Scene& scene, const Surface& surface, const ResinVolume& twin,
                                                    const Progress* progress = nullptr) const override;
    /// What a prediction of a body of so many mm^3, in voxels of this pitch, needs at the least: can be told before
    /// there is a volume. It may need much more.
    [[nodiscard]] std::size_t least_bytes(double solid_mm3, const std::array<double, 3>& pitch_mm) const;

    /// A ViewingSequence, with what is not worked at outside of memory where that is short (TransportOptions::scratch);
    /// predictions anew each time where it does not allow one.
    [[nodiscard]] std::unique_ptr<AppearanceSequence> sequence(const Scene& scene, const Surface& surface,
                                                               const Progress* progress = nullptr) const override;

private:
    TransportOptions options_;
};

}  // namespace voxtone::optics

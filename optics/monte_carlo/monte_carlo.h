// SPDX-License-Identifier: GPL-3.0-or-later
//
// The reference: appearance by volumetric path tracing through the voxels of resins. Everything that the scene says is
// simulated as it is (scalar_paths.h): Henyey-Greenstein scattering, refraction and total reflection at the surface,
// finite bodies, backing. The only error is noise, and its size stands beside every value.
//
// Noise: the standard error falls with the square root of the number of paths; a value of 0.5 has about 0.4 per path.
// Every channel has its own paths: tracing three at once with weights (hero wavelength, balance heuristic) was measured
// to cost 4 to 8 times as much for the same error in white resin, 1.4 to 2.7 times in coloured resins, whose
// extinctions differ too much; it wins only where a channel is all but black. Time: docs/benchmarks.md. Paths are drawn
// in tasks of 4096, which any thread may take; weights are added up as whole numbers, so a result has the same bits for
// any number of threads.
//
// A staircase of voxels is rougher than the surface it stands for: where the body is curved or tilted light enters and
// leaves at the corners of voxels and colours are up to 7 CIEDE2000 too light. Give the true surface as `boundary`
// there.
#pragma once

#include "optics/monte_carlo/monte_carlo_options.h"
#include "optics/scene/appearance_model.h"

namespace voxtone::optics {

class MonteCarlo : public AppearanceModel {
public:
    explicit MonteCarlo(const MonteCarloOptions& options = {});

    [[nodiscard]] Appearance predict(const Scene& scene, const Surface& surface,
                                     const Progress* progress = nullptr) const override;
    /// The twin by the seed's complement.
    [[nodiscard]] TwinAppearances predict_with_twin(const Scene& scene, const Surface& surface, const ResinVolume& twin,
                                                    const Progress* progress = nullptr) const override;
    /// The same, and what it took.
    [[nodiscard]] Appearance predict(const Scene& scene, const Surface& surface, MonteCarloSummary& summary,
                                     const Progress* progress = nullptr) const;

    /// The geometry of calibration, rho(45 -> 0) = pi L_o / E of each cell, for a flat print seen from above: every
    /// face of the surface is on the top of the volume, and all of that top is resin. Open, mirrored, on any backing;
    /// only the top is lit. Traced path by path (directional_paths.h). Throws InputError where the print is not flat.
    [[nodiscard]] Appearance reflectance_45_0(const Scene& scene, const Surface& surface, MonteCarloSummary& summary,
                                              const Progress* progress = nullptr) const;

private:
    MonteCarloOptions options_;
};

}  // namespace voxtone::optics

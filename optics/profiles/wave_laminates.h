// SPDX-License-Identifier: GPL-3.0-or-later
//
// What laminates of resins reflect and transmit, wave by wave in all directions (optics/layered/wave_ordinates.h).
//
// Where layer profiles (layer_profile.h) take light between layers as diffuse, this keeps its angle: the way that it
// runs in and the side that it spreads to. Surfaces and sheets are part of it. It shares nothing with Monte Carlo but
// the resins; docs/profiles.md says how near both come.
//
// Time: most goes into doubling thin layers, which depends on resin and wave alone. A laminate of layers of whole
// `unit_mm` is put together of doubled ones that are kept: a laminate more is then cheap.
#pragma once

#include <span>
#include <vector>

#include "optics/layered/wave_ordinates.h"
#include "optics/profiles/resin_laminate.h"

namespace voxtone::optics {

struct WaveOptions {
    int trapped = 4, escaping = 4;  ///< directions of a hemisphere; without a surface all are of one rule
    int orders = 6;                 ///< of azimuth
    /// Thicknesses are rounded to whole multiples, at least one, and doubled layers are kept for the next laminate;
    /// 0: each layer is made at its own thickness, nothing is kept.
    double unit_mm = 0;
};

class WaveLaminates {
public:
    /// `set` must outlive this. Contract: as LaminateEnds. Where layers are kept: some (directions x orders)^2 x 16
    /// bytes for each of 13 doublings, resin, channel and coefficient.
    WaveLaminates(const ResinSet& set, const LaminateEnds& ends, const HankelGrid& grid, const WaveOptions& options);

    /// No errors are known. Contract: at least one layer, thicknesses > 0, resins of the set. From any thread.
    [[nodiscard]] LaminateLight light(std::span<const ResinLayer> layers, const Progress* progress = nullptr) const;

private:
    struct Light {
        double R, T;
    };
    [[nodiscard]] Light light_of(std::span<const ResinLayer> layers, std::size_t channel, std::size_t wave) const;
    [[nodiscard]] WavesBelow through(const ResinLayer& layer, std::size_t channel, std::size_t wave,
                                     WavesBelow below) const;
    [[nodiscard]] std::size_t kept_at(std::size_t resin, std::size_t channel, std::size_t wave) const;

    const ResinSet& set_;
    LaminateEnds ends_;
    std::vector<double> k_;
    WaveOptions options_;
    WaveOrdinates ordinates_;
    std::vector<std::vector<LayerWaves>> kept_;  ///< of unit_mm, 2, 4, ...
};

/// Of one laminate, at its own thicknesses.
[[nodiscard]] LaminateLight layered_light(const ResinSet& set, std::span<const ResinLayer> layers,
                                          const LaminateEnds& ends, const HankelGrid& grid,
                                          const Progress* progress = nullptr);

}  // namespace voxtone::optics

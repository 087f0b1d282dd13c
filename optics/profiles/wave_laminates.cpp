// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/profiles/wave_laminates.h"

#include <algorithm>
#include <cmath>

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/numerics/dense.h"

namespace voxtone::optics {
namespace {

constexpr std::size_t doublings = 13;

AngularGrid directions_between(const LaminateEnds& ends, const WaveOptions& options) {
    const double eta = std::max(ends.eta_top, ends.eta_bottom);
    VOXTONE_EXPECT(ends.eta_top == eta || ends.eta_top == 1);
    VOXTONE_EXPECT(ends.eta_bottom == eta || ends.eta_bottom == 1);
    return angular_grid(eta, options.trapped, options.escaping);
}

Eigen::ArrayXd reflectance_at(const AngularGrid& grid, double eta) {
    return eta == 1 ? Eigen::ArrayXd::Zero(grid.size()).eval() : grid.r;
}

}  // namespace

WaveLaminates::WaveLaminates(const ResinSet& set, const LaminateEnds& ends, const HankelGrid& grid,
                             const WaveOptions& options)
    : set_(set),
      ends_(ends),
      k_(grid.k().begin(), grid.k().end()),
      options_(options),
      ordinates_(directions_between(ends, options), set.g, options.orders) {
    VOXTONE_EXPECT(ends.sheet == 0 || ends.eta_bottom == 1);
    VOXTONE_EXPECT(options.unit_mm >= 0);
    if (options.unit_mm == 0) return;
    kept_.resize(set.resins.size() * set.channels.size() * k_.size());
    parallel_for(0, kept_.size(), 1, [&](std::size_t i) {
        const std::size_t wave = i % k_.size(), of = i / k_.size();
        const Medium medium = set.resins[of / set.channels.size()].medium(of % set.channels.size());
        if (WaveOrdinates::is_unscattering(medium, options.unit_mm)) return;
        std::vector<LayerWaves>& pieces = kept_[i];
        pieces.push_back(ordinates_.layer(medium, options.unit_mm, k_[wave]));
        while (pieces.size() < doublings) pieces.push_back(WaveOrdinates::doubled(pieces.back()));
    });
}

std::size_t WaveLaminates::kept_at(std::size_t resin, std::size_t channel, std::size_t wave) const {
    return (resin * set_.channels.size() + channel) * k_.size() + wave;
}

WavesBelow WaveLaminates::through(const ResinLayer& layer, std::size_t channel, std::size_t wave,
                                  WavesBelow below) const {
    if (options_.unit_mm > 0) {
        const std::vector<LayerWaves>& pieces = kept_[kept_at(layer.resin, channel, wave)];
        if (!pieces.empty()) {
            auto units = std::max(1LL, std::llround(layer.thickness_mm / options_.unit_mm));
            for (std::size_t i = 0; i + 1 < doublings; ++i, units /= 2)
                if (units % 2 == 1) below = below.under(pieces[i]);
            for (; units > 0; --units) below = below.under(pieces.back());
            return below;
        }
    }
    return below.under(ordinates_.layer(set_.resins[layer.resin].medium(channel), layer.thickness_mm, k_[wave]));
}

WaveLaminates::Light WaveLaminates::light_of(std::span<const ResinLayer> layers, std::size_t channel,
                                             std::size_t wave) const {
    const AngularGrid& at = ordinates_.grid();
    const Eigen::ArrayXd top = reflectance_at(at, ends_.eta_top), bottom = reflectance_at(at, ends_.eta_bottom);
    const Eigen::VectorXd leaving = ordinates_.all_around(at.c * (1 - top));
    WavesBelow below{ordinates_.mirrored(bottom).asDiagonal(), ordinates_.all_around(at.c * (1 - bottom)).transpose()};
    if (ends_.sheet > 0) {
        below.R = ends_.sheet * ordinates_.all_around(Eigen::ArrayXd::Ones(at.size())) * below.leaving;
        below.leaving *= 1 - ends_.sheet;
    }
    for (auto layer = layers.rbegin(); layer != layers.rend(); ++layer)
        below = through(*layer, channel, wave, std::move(below));
    // Down below the surface: what comes in, and what the surface sends back of what comes up.
    const Eigen::VectorXd comes_in = ordinates_.all_around((1 - top) / (at.c * (1 - top)).sum());
    const Eigen::Index n = comes_in.size();
    const Eigen::MatrixXd lost = Eigen::MatrixXd::Identity(n, n) - scaled_rows(ordinates_.mirrored(top), below.R);
    const Eigen::VectorXd down = preimage(lost, comes_in);
    return {leaving.dot(image(below.R, down)), below.leaving * down};
}

LaminateLight WaveLaminates::light(std::span<const ResinLayer> layers, const Progress* progress) const {
    VOXTONE_EXPECT(!layers.empty());
    for (const ResinLayer& layer : layers) VOXTONE_EXPECT(layer.resin < set_.resins.size() && layer.thickness_mm > 0);
    const std::size_t channels = set_.channels.size(), waves = k_.size();
    LaminateLight light{std::vector(channels, std::vector<double>(waves)),
                        std::vector(channels, std::vector<double>(waves)), std::vector<double>(channels),
                        std::vector<double>(channels)};
    parallel_for(
        0, channels * waves, 1,
        [&](std::size_t i) {
            const Light of = light_of(layers, i / waves, i % waves);
            light.R[i / waves][i % waves] = of.R;
            light.T[i / waves][i % waves] = of.T;
        },
        progress);
    return light;
}

LaminateLight layered_light(const ResinSet& set, std::span<const ResinLayer> layers, const LaminateEnds& ends,
                            const HankelGrid& grid, const Progress* progress) {
    return WaveLaminates(set, ends, grid, {}).light(layers, progress);
}

}  // namespace voxtone::optics

// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/seen_medium.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/contracts.h"
#include "base/parallel.h"

namespace voxtone::optics {
namespace {

/// f_r of the header, with w_l = exp(-step l); returns sum_rl s_rl w_l.
double weigh_layers(const Mixture& mixture, double step, std::vector<double>& fractions) {
    std::fill(fractions.begin(), fractions.end(), 0.0);
    double all = 0;
    for (const auto& [material, layer, share] : mixture.holds) {
        const double weight = static_cast<double>(share) * std::exp(-step * layer);
        all += weight;
        fractions[material - 1u] += weight;
    }
    for (double& f : fractions) f /= all;
    return all;
}

}  // namespace

double SeenMedium::fall(const Medium& mean, std::size_t axis) const {
    // Fitted on the whole accuracy suite (`predictor_accuracy --fine 0 compare tests/data/appearance`), which is
    // therefore no test of it. 1 would be light that falls and leaves as diffuse light does.
    constexpr double strength = 0.8;
    const double kappa = std::sqrt(3 * mean.sigma_a * (mean.sigma_a + (1 - resins.g) * mean.sigma_s));
    return 2 * strength * kappa * pitch_mm[axis];
}

Medium SeenMedium::operator()(const Mixture& mixture, std::size_t channel) const {
    if (mixture.holds.size() == 1) {
        const auto [material, layer, share] = mixture.holds[0];
        const Medium whole = resins.resins[material - 1u].medium(channel);
        return {static_cast<double>(share) * whole.sigma_a, static_cast<double>(share) * whole.sigma_s};
    }
    std::vector<double> fractions(resins.resins.size());
    double filled = 0;
    int layers = 0;
    for (const auto& [material, layer, share] : mixture.holds) {
        filled += static_cast<double>(share);
        layers = std::max(layers, layer + 1);
    }
    for (const auto& [material, layer, share] : mixture.holds)
        fractions[material - 1u] += static_cast<double>(share) / filled;
    Medium medium = halftone(fractions, channel);
    if (layers > 1) {
        weigh_layers(mixture, fall(medium, mixture.axis), fractions);
        medium = halftone(fractions, channel);
    }
    return {filled * medium.sigma_a, filled * medium.sigma_s};
}

void SeenMedium::derivatives(const Mixture& mixture, std::size_t channel, std::size_t axis, std::size_t layers,
                             std::span<std::array<double, 2>> out) const {
    const std::size_t n = resins.resins.size();
    VOXTONE_EXPECT(out.size() == n * layers);
    std::vector<double> fractions(n), by_absorption(n), by_scattering(n);
    double filled = 0;
    bool layered = false;
    for (const auto& [material, layer, share] : mixture.holds) {
        filled += static_cast<double>(share);
        fractions[material - 1u] += static_cast<double>(share);
        layered |= layer > 0;
    }
    for (double& f : fractions) f /= filled;
    const bool alone = mixture.holds.size() == 1;
    const double step = layered || alone ? fall(halftone(fractions, channel), axis) : 0;
    double all = 0;  // sum of s w
    if (alone) {
        for (std::size_t l = 0; l < layers; ++l)
            all += filled / static_cast<double>(layers) * std::exp(-step * static_cast<double>(l));
    } else {
        all = weigh_layers(mixture, step, fractions);
    }
    const EffectiveMedium::Point point = halftone.at(fractions, channel);
    halftone.gradient(point, channel, 1, 0, by_absorption);
    halftone.gradient(point, channel, 0, 1, by_scattering);
    double mean_a = 0, mean_s = 0;
    for (std::size_t r = 0; r < n; ++r) {
        mean_a += fractions[r] * by_absorption[r];
        mean_s += fractions[r] * by_scattering[r];
    }
    for (std::size_t l = 0; l < layers; ++l) {
        const double weight = filled * std::exp(-step * static_cast<double>(l)) / all;
        for (std::size_t r = 0; r < n; ++r)
            out[l * n + r] = {point.medium.sigma_a + weight * (by_absorption[r] - mean_a),
                              point.medium.sigma_s + weight * (by_scattering[r] - mean_s)};
    }
}

namespace {

constexpr std::size_t media_per_task = 1 << 8;

std::vector<TransportMedium> media_of_mixtures(const TransportMedia& media_of, const SeenMedium& seen,
                                               const std::vector<Mixture>& mixtures, std::size_t channel) {
    std::vector<TransportMedium> media(mixtures.size());
    parallel_for(1, mixtures.size(), media_per_task, [&](std::size_t m) {
        media[m] = media_of(seen(mixtures[m], channel));
        media[m].apart = mixtures[m].apart;
    });
    return media;
}

/// By GridContents::core_medium.
std::vector<TransportMedium> media_of_core(const ViewingGrid& grid, const EffectiveMedium& halftone,
                                           const ResinSet& resins, std::size_t channel) {
    const std::size_t halftones = grid.core_shares.size() / grid.resins;
    std::vector<TransportMedium> media(1 + grid.resins + halftones);
    for (std::size_t r = 0; r < grid.resins; ++r)
        media[1 + r] = similar_medium(grid.directions, resins.resins[r].medium(channel));
    parallel_for(0, halftones, media_per_task, [&](std::size_t i) {
        const std::span<const float> shares = std::span(grid.core_shares).subspan(i * grid.resins, grid.resins);
        const std::vector<double> fractions(shares.begin(), shares.end());
        media[1 + grid.resins + i] = similar_medium(grid.directions, halftone(fractions, channel));
    });
    return media;
}

/// Mean share over a rectangle of the plane z = 0, voxels, of what leaves there that a sheet sends back.
float sent_back_under(const ViewingGrid& grid, const Place& from, const std::array<int, 2>& extent, double rho,
                      std::size_t channel) {
    constexpr int samples = 4;  // along each axis
    double sum = 0;
    for (int j = 0; j < samples; ++j)
        for (int i = 0; i < samples; ++i) {
            const double x = (from[0] + (i + 0.5) / samples * extent[0]) * grid.pitch_mm[0],
                         y = (from[1] + (j + 0.5) / samples * extent[1]) * grid.pitch_mm[1];
            sum += share_sent_back(static_cast<double>(grid.sheet->at(x, y, channel)), rho);
        }
    return static_cast<float>(sum / (samples * samples));
}

void add_sheet(const ViewingGrid& grid, double eta, std::size_t channel, GridMedia& media) {
    const double rho = reflectance_in_air(eta);
    const auto& view = grid.view_voxels;
    media.sheet.assign(grid.open_faces.size(), 0.0f);
    parallel_for(0, grid.open_faces.size(), 1 << 10, [&](std::size_t i) {
        const OuterFace& face = grid.faces[grid.open_faces[i]];
        if (face.kind != FaceKind::white_sheet) return;
        Place from = grid.corner_of(grid.transport_block(face.cell / 64).at);
        for (std::size_t a = 0; a < 2; ++a) from[a] += view[a] * (static_cast<int>(face.cell) >> (2 * a) & 3);
        media.sheet[i] = sent_back_under(grid, from, {view[0], view[1]}, rho, channel);
    });
    media.core_sheet.assign(grid.core_block.size(), 0.0f);
    for (std::size_t i = 0; i < media.core_sheet.size(); ++i)
        if (const GridBlock& block = grid.blocks[grid.core_block[i]]; grid.is_on_sheet(block.at))
            media.core_sheet[i] =
                sent_back_under(grid, grid.corner_of(block.at), {4 * view[0], 4 * view[1]}, rho, channel);
}

}  // namespace

std::shared_ptr<const TransportMedia> media_of_cells(const ViewingGrid& grid) {
    return shared_media(grid.directions, grid.edge_mm(), viewing_theta);
}

GridMedia media_of_grid(const ViewingGrid& grid, const EffectiveMedium& halftone, const ResinSet& resins,
                        std::size_t channel) {
    const SeenMedium seen{halftone, resins, grid.pitch_mm};
    GridMedia media;
    media.cells = media_of_mixtures(*media_of_cells(grid), seen, grid.mixtures, channel);
    media.core = media_of_core(grid, halftone, resins, channel);
    if (grid.backing == Backing::sheet) add_sheet(grid, resins.eta, channel, media);
    if (!grid.fine.any()) return media;
    std::array<double, 3> edge = grid.edge_mm();
    for (std::size_t a = 0; a < 3; ++a) edge[a] /= grid.fine.split[a];
    media.parts =
        media_of_mixtures(*shared_media(grid.directions, edge, fine_theta), seen, grid.fine.contents, channel);
    return media;
}

}  // namespace voxtone::optics

// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/viewing_media.h"

#include "base/parallel.h"
#include "optics/transport/seen_medium.h"

namespace voxtone::optics {
namespace {

constexpr std::size_t media_per_task = 1 << 8;

std::vector<TransportMedium> media_of_mixtures(const TransportMedia& media_of, const SeenMedium& seen,
                                               const std::vector<ViewingGrid::Mixture>& mixtures, std::size_t channel) {
    std::vector<TransportMedium> media(mixtures.size());
    parallel_for(1, mixtures.size(), media_per_task,
                 [&](std::size_t m) { media[m] = media_of(seen(mixtures[m], channel)); });
    return media;
}

/// By GridBlock::medium.
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

}  // namespace

std::shared_ptr<const TransportMedia> media_of_cells(const ViewingGrid& grid) {
    return shared_media(grid.directions, grid.edge_mm(), viewing_theta);
}

ViewingTransport::Media media_of_grid(const ViewingGrid& grid, const EffectiveMedium& halftone, const ResinSet& resins,
                                      std::size_t channel) {
    const SeenMedium seen{halftone, resins, grid.pitch_mm};
    ViewingTransport::Media media;
    media.cells = media_of_mixtures(*media_of_cells(grid), seen, grid.mixtures, channel);
    media.core = media_of_core(grid, halftone, resins, channel);
    if (!grid.fine.any()) return media;
    std::array<double, 3> edge = grid.edge_mm();
    for (std::size_t a = 0; a < 3; ++a) edge[a] /= grid.fine.split[a];
    media.parts =
        media_of_mixtures(*shared_media(grid.directions, edge, fine_theta), seen, grid.fine.contents, channel);
    return media;
}

}  // namespace voxtone::optics

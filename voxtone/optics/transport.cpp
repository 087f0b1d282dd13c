// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/optics/transport.h"

#include <algorithm>
#include <chrono>
#include <string>

#include "voxtone/base/contracts.h"
#include "voxtone/base/error.h"
#include "voxtone/optics/diffusion.h"
#include "voxtone/optics/transport_channel.h"

namespace voxtone::optics {
namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

Medium mixed(const ResinSet& resins, const PaletteEntry& entry, std::size_t channel) {
    Medium sum;
    for (const auto& [material, share] : entry.shares) {
        const Medium m = resins.resins[material - 1u].medium(channel);
        sum.sigma_a += static_cast<double>(share) * m.sigma_a;
        sum.sigma_s += static_cast<double>(share) * m.sigma_s;
    }
    return sum;
}

}  // namespace

TransportPredictor::TransportPredictor(const TransportOptions& options) : options_(options) {
    if (options.sweeps < 1) throw UsageError("the predictor needs at least 1 sweep, not " + std::to_string(options.sweeps));
    if (!(options.cell_mm > 0)) throw UsageError("the predictor's cells must be larger than 0 mm");
    if (options.margin_blocks < 0 || options.margin_blocks > 64)
        throw UsageError("the predictor's margin must be 0 to 64 blocks");
}

Appearance TransportPredictor::predict(const Scene& scene, const Surface& surface, const Progress* progress) const {
    TransportSummary summary;
    return predict(scene, surface, summary, progress);
}

Appearance TransportPredictor::predict(const Scene& scene, const Surface& surface, TransportSummary& summary,
                                       const Progress* progress) const {
    VOXTONE_EXPECT(scene.volume && scene.resins);
    const double begin = now();
    GridOptions grid_options;
    grid_options.view_voxels = cell_voxels(scene.volume->pitch_mm(), options_.cell_mm);
    grid_options.skin_voxels = options_.voxel_skin ? std::array<int, 3>{1, 1, 1} : grid_options.view_voxels;
    grid_options.margin_blocks = options_.margin_blocks;
    const OpticalGrid grid(scene, grid_options);
    const DiffusionPlan plan(grid);
    for (const std::uint32_t b : grid.transport_blocks) {
        const auto n = grid.cells_in(grid.blocks[b].kind);
        (grid.blocks[b].kind == BlockKind::skin ? summary.skin_cells : summary.margin_cells) +=
            static_cast<std::size_t>(n[0] * n[1] * n[2]);
    }
    summary.nodes = grid.nodes.size();
    summary.memory_bytes = grid.memory_bytes() + plan.memory_bytes();
    std::vector<std::int64_t> face(surface.faces.size());
    for (std::size_t i = 0; i < face.size(); ++i) face[i] = grid.face_at(surface.faces[i]);
    summary.grid_s = now() - begin;

    const TransportMedia media_of(grid.directions);
    const std::size_t channels = scene.resins->channels.size();
    Appearance appearance;
    appearance.channels = channels;
    appearance.value.assign(surface.cells.size() * channels, 0.0f);
    for (std::size_t c = 0; c < channels; ++c) {
        std::vector<TransportMedium> media(grid.palette.size());
        for (std::size_t i = 1; i < media.size(); ++i) media[i] = media_of(mixed(*scene.resins, grid.palette[i], c));
        TransportChannel channel(grid, plan, std::move(media), options_);
        channel.solve({}, summary, progress);
        for (std::size_t i = 0; i < surface.cells.size(); ++i) {
            const SurfaceCell& cell = surface.cells[i];
            double leaving = 0, entering = 0;
            for (std::size_t f = cell.first_face; f < cell.first_face + cell.faces; ++f) {
                if (face[f] < 0) continue;
                leaving += channel.flux()[static_cast<std::size_t>(face[f])];
                entering += channel.furnace_flux(static_cast<std::size_t>(face[f]));
            }
            appearance.value[i * channels + c] = static_cast<float>(entering > 0 ? leaving / entering : 0);
        }
        summary.last_change.push_back(channel.last_change());
    }
    summary.total_s = now() - begin;
    return appearance;
}

}  // namespace voxtone::optics

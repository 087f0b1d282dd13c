// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/optics/viewing_sequence.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include "voxtone/base/contracts.h"
#include "voxtone/base/error.h"
#include "voxtone/base/parallel.h"
#include "voxtone/optics/seen_medium.h"
#include "voxtone/optics/viewing_gradient.h"

namespace voxtone::optics {
namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

bool looks_up(const Surface& surface) {
    double up = 0, all = 0;
    for (const SurfaceCell& cell : surface.cells) {
        up += static_cast<double>(cell.area_mm2 * std::abs(cell.normal[2]));
        all += static_cast<double>(cell.area_mm2);
    }
    return up > 0.9 * all;
}

}  // namespace

ViewingSequence::ViewingSequence(const Scene& scene, const Surface& surface, const TransportOptions& options)
    : scene_(scene), surface_(surface), options_(options),
      halftone_(*scene.resins, scene.volume->pitch_mm(), looks_up(surface) ? SeenFrom::above : SeenFrom::all_sides) {
    fields_.resize(scene.resins->channels.size());
    make_grid(scene, {});
}

void ViewingSequence::make_grid(const Scene& scene, std::span<const std::uint8_t> also) {
    const double begin = now();
    transport_.reset();
    grid_ = std::make_unique<ViewingGrid>(scene, cell_voxels(scene.volume->pitch_mm(), options_.cell_mm), options_.colour_mm, also);
    grid_->shrink();
    seen_ = grid_->see(surface_);
    const std::size_t needed = grid_->memory_bytes() + ViewingTransport::bytes_for(*grid_, fields_.size());
    if (options_.memory_bytes > 0 && needed > options_.memory_bytes)
        throw ResourceError("a sequence of predictions of " + std::to_string(grid_->cells()) + " viewing cells needs " +
                            std::to_string((needed >> 20) + 1) + " MiB of memory and " + std::to_string(options_.memory_bytes >> 20) +
                            " are allowed: allow more, expect colour less deep, or take larger cells");
    transport_ = std::make_unique<ViewingTransport>(*grid_, options_);
    summary_.skin_cells = grid_->cells();
    summary_.nodes = grid_->cells() + grid_->core_block.size();
    summary_.pieces = 1;
    summary_.grid_s += now() - begin;
}

/// Light of the cells that both grids have; where the new one has cells in what was core, the core's.
void ViewingSequence::carry_over(const ViewingGrid& from) {
    const OpticalGrid &was = from.grid, &is = grid_->grid;
    for (ViewingField& field : fields_) {
        if (field.cells.empty()) continue;
        ViewingField next;
        next.cells.resize(grid_->cells());
        next.core.resize(grid_->core_block.size());
        for (std::size_t place = 0; place < is.block_at.size(); ++place) {
            if (is.block_at[place] < 0) continue;
            const GridBlock &to = is.blocks[static_cast<std::size_t>(is.block_at[place])],
                            &of = was.blocks[static_cast<std::size_t>(was.block_at[place])];
            if (of.kind != BlockKind::core && to.kind != BlockKind::core) {
                std::copy_n(field.cells.begin() + of.first_cell, 64, next.cells.begin() + to.first_cell);
            } else if (of.kind == BlockKind::core && to.kind == BlockKind::core) {
                next.core[to.first_node] = field.core[of.first_node];
            } else if (to.kind != BlockKind::core) {
                ViewingField::Code code;
                code.phi = phi_code(field.core[of.first_node]);
                std::fill_n(next.cells.begin() + to.first_cell, 64, code);
            } else {
                double sum = 0;
                for (std::size_t k = 0; k < 64; ++k) sum += phi_of(field.cells[of.first_cell + k]);
                next.core[to.first_node] = static_cast<float>(sum / 64);
            }
        }
        // Blocks with open faces are the same in both, and so is their order.
        VOXTONE_ENSURE(from.open_faces.size() == grid_->open_faces.size());
        next.out = std::move(field.out);
        field = std::move(next);
    }
}

Appearance ViewingSequence::next(const ResinVolume& volume, const Progress* progress) {
    const double begin = now();
    VOXTONE_EXPECT(volume.size() == scene_.volume->size());
    Scene scene = scene_;
    scene.volume = &volume;
    expect_resins_for(scene);
    std::vector<std::uint8_t> wanted;
    if (!grid_->fill(volume, wanted)) {
        also_.resize(wanted.size(), 0);
        for (std::size_t i = 0; i < wanted.size(); ++i) also_[i] |= wanted[i];
        const std::unique_ptr<ViewingGrid> was = std::move(grid_);
        make_grid(scene, also_);
        carry_over(*was);
        adjoint_.clear();
    }
    const std::size_t channels = scene_.resins->channels.size();
    Appearance appearance;
    appearance.channels = channels;
    appearance.value.assign(surface_.cells.size() * channels, 0.0f);
    summary_.last_change.assign(channels, 0.0);
    for (std::size_t c = 0; c < channels; ++c) {
        const ViewingTransport::Media in = media(c);
        transport_->solve(in, fields_[c], fields_[c].cells.empty() ? options_.sweeps : options_.next_sweeps, summary_, progress);
        summary_.last_change[c] = transport_->last_change();
        const auto flux = transport_->flux();
        for (std::size_t i = 0; i < surface_.cells.size(); ++i) {
            float leaving = 0, furnace = 0;
            for (std::uint32_t e = seen_.first[i]; e < seen_.first[i + 1]; ++e) {
                leaving += seen_.share[e] * flux[seen_.face[e]];
                furnace += seen_.share[e] * transport_->furnace_flux(seen_.face[e]);
            }
            // Inside a bubble smaller than a cell the light is that of the cell.
            appearance.value[i * channels + c] = furnace > 0                    ? leaving / furnace
                                                 : seen_.cell[i] != 0xffffffffu ? transport_->phi(seen_.cell[i])
                                                                                : 0;
        }
    }
    summary_.memory_bytes = grid_->memory_bytes() + transport_->memory_bytes();
    for (const auto* const fields : {&fields_, &adjoint_})
        for (const ViewingField& field : *fields) summary_.memory_bytes += field.memory_bytes();
    summary_.total_s += now() - begin;
    return appearance;
}

ViewingTransport::Media ViewingSequence::media(std::size_t channel) const {
    const OpticalGrid& grid = grid_->grid;
    const ResinSet& resins = *scene_.resins;
    const auto media_of = shared_media(grid.directions, grid.edge_mm(BlockKind::skin), viewing_theta);
    const SeenMedium seen{halftone_, resins, grid.pitch_mm};
    ViewingTransport::Media media;
    media.cells.resize(grid.palette.size());
    media.core.resize(resins.resins.size() + 1);
    for (std::size_t m = 1; m < media.core.size(); ++m) media.core[m] = similar_medium(grid.directions, resins.resins[m - 1].medium(channel));
    parallel_for(1, grid.palette.size(), 1 << 8, [&](std::size_t m) { media.cells[m] = (*media_of)(seen(grid_->mixtures[m], channel)); });
    return media;
}

std::unique_ptr<const ResinGradient> ViewingSequence::gradient(std::span<const float> by_value, const Progress* progress) {
    const double begin = now();
    const OpticalGrid& grid = grid_->grid;
    const ResinSet& resins = *scene_.resins;
    const std::size_t channels = fields_.size();
    VOXTONE_EXPECT(by_value.size() == surface_.cells.size() * channels);
    VOXTONE_EXPECT(!fields_[0].cells.empty());
    // Fields of both lights, the derivatives, and copies of the light on the faces.
    const std::size_t needed = grid_->memory_bytes() + ViewingTransport::bytes_for(*grid_, 2 * channels) + grid_->cells() * (4 * channels + 8) +
                               grid_->open_faces.size() * 8 * sizeof(Octet);
    if (options_.memory_bytes > 0 && needed > options_.memory_bytes) return nullptr;
    adjoint_.resize(channels);
    const auto media_of = shared_media(grid.directions, grid.edge_mm(BlockKind::skin), viewing_theta);
    const SeenMedium seen{halftone_, resins, grid.pitch_mm};
    auto gradient = std::make_unique<ViewingGradient>(*grid_, seen, channels);
    std::vector<float> light(grid.faces.size()), by_sigma_t(grid_->cells()), by_sigma_s(grid_->cells());
    for (std::size_t c = 0; c < channels; ++c) {
        const ViewingTransport::Media in = media(c);
        std::fill(light.begin(), light.end(), 0.0f);
        for (std::size_t i = 0; i < surface_.cells.size(); ++i) {
            float furnace = 0;
            for (std::uint32_t e = seen_.first[i]; e < seen_.first[i + 1]; ++e) furnace += seen_.share[e] * transport_->furnace_flux(seen_.face[e]);
            for (std::uint32_t e = seen_.first[i]; furnace > 0 && e < seen_.first[i + 1]; ++e)
                light[seen_.face[e]] += by_value[i * channels + c] * seen_.share[e] / furnace;
        }
        transport_->solve(in, adjoint_[c], adjoint_[c].cells.empty() ? options_.sweeps : options_.next_sweeps, summary_, progress, light);
        transport_->derivatives(fields_[c], by_sigma_t, by_sigma_s);
        gradient->add(c, *media_of, seen, by_sigma_t, by_sigma_s);
    }
    summary_.memory_bytes = grid_->memory_bytes() + transport_->memory_bytes() + gradient->memory_bytes() + 4 * (light.size() + by_sigma_t.size() + by_sigma_s.size());
    for (const auto* const fields : {&fields_, &adjoint_})
        for (const ViewingField& field : *fields) summary_.memory_bytes += field.memory_bytes();
    summary_.total_s += now() - begin;
    return gradient;
}

}  // namespace voxtone::optics

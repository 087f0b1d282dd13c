// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/channel_media.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "optics/numerics/portable_math.h"

namespace voxtone::optics {
namespace {

// mm^-1: diffusion is only a guess in clear resin. Of 0.2, corrections of a wall of clear and white voxels grew without
// bound, as if light went through cells where sweeps saw it stay.
constexpr float least_transport_sigma = 1;

// Keep the corrections stable on cells as thick as a free path, where diffusion overshoots and the iteration would
// grow: artificial diffusion, in edges of a cell added to D per optical depth of one, and at most (the form is that of
// Zhu et al. 2016, "An optimally diffusive coarse mesh finite difference method to accelerate neutron transport
// calculations", Ann. Nucl. Energy 95:116). The figures are this iteration's own, not values of their polynomial: with
// them it converges at 0.29 to 0.39 a sweep (convergence_test.cpp).
constexpr float widening = 0.55f, most_widening = 0.75f;

}  // namespace

ChannelMedia::ChannelMedia(const TransportParameters& of_grid, const GridMedia& of) : parameters(of_grid), media(of) {
    const ViewingGrid& grid = parameters.grid;
    const auto linear = static_cast<float>(grid.directions.linear);
    const float widest = *std::ranges::max_element(parameters.edge);
    const auto find = [&](const std::vector<TransportMedium>& list, std::vector<float>& diffusion,
                          std::vector<float>& wide) {
        diffusion.assign(list.size(), 0.0f);
        wide.assign(list.size(), 0.0f);
        for (std::size_t m = 1; m < list.size(); ++m) {
            diffusion[m] = 1 / (3 * std::max(list[m].sigma_t - linear * list[m].sigma_s, least_transport_sigma));
            wide[m] = diffusion[m] + widest * std::min(most_widening, widening * widest / (3 * diffusion[m]));
        }
    };
    find(media.cells, D, widened);
    find(media.core, core_D, core_widened);
    fit_core(widest);
    core_loss.resize(grid.core_block.size());
    for (std::size_t i = 0; i < core_loss.size(); ++i) core_loss[i] = loss_of_core(i);
    std::array<double, 3> edge_mm = grid.edge_mm();
    cell_ways = sweep_media(grid.directions, edge_mm, static_cast<float>(viewing_theta), media.cells);
    if (grid.fine.any())
        for (std::size_t a = 0; a < 3; ++a) edge_mm[a] /= grid.fine.split[a];
    part_ways = sweep_media(grid.directions, edge_mm, static_cast<float>(fine_theta), media.parts);
    exchange.resize(grid.faces.size());
    parallel_ranges(0, exchange.size(), 1 << 12, [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f)
            if (grid.faces[f].kind != FaceKind::core) exchange[f] = exchange_at(f);
    });
}

/// Light decays across a block of one node, by e^-2x: with D x / tanh x and sigma_a sinh 2x / 2x nodes in a row have
/// the values of e^-2xn in their middles, and the first of them takes up what a half-space does, phi D / (diffusion
/// length) (exponential fitting, as for cells in transport_sweep.h). Exact along the axes.
void ChannelMedia::fit_core(float widest) {
    constexpr float exact = 1e-3f, dark = 4;  // beyond, no light comes back
    core_sigma_a.resize(core_D.size());
    for (std::size_t m = 0; m < core_D.size(); ++m) {
        core_sigma_a[m] = media.core[m].sigma_t - media.core[m].sigma_s;
        if (!(core_D[m] > 0 && core_sigma_a[m] > 0)) continue;
        const float x = std::min(2 * widest * std::sqrt(core_sigma_a[m] / core_D[m]), dark);
        if (x < exact) continue;
        const float wider = core_D[m] * (x / portable::tanh(x) - 1);
        core_D[m] += wider;
        core_widened[m] += wider;
        core_sigma_a[m] *= portable::sinh(2 * x) / (2 * x);
    }
}

/// J = (T phi / 4 - S) / (1 - T / 2 + T h / (4 D)), S the current that comes in (Marshak's condition).
ChannelMedia::Exchange ChannelMedia::exchange_at(std::size_t f) const {
    const OuterFace& face = parameters.grid.faces[f];
    const TransportParameters::FaceSums& sums = parameters.sums[parameters.grid.law[f]];
    if (face.kind == FaceKind::mirror) return {0, face.area_mm2};
    const float T = (face.kind == FaceKind::white_sheet ? 1 - sent_back(f) : 1.0f) * (sums.through / sums.weight);
    const float below =
        1 - T / 2 + T * 0.5f * parameters.edge[parameters.axis_of(f)] / (4 * D[parameters.grid.medium[face.cell]]);
    return {face.area_mm2 * T / 4 / below, face.area_mm2 / below};
}

/// What a node loses for its phi: what it absorbs, and what a sheet takes (sheet_way.h). Where the share R of what
/// leaves comes in again, J = (1 - R) (T phi / 4 + U J / 2), and phi / J is 4 R / ((1 - R) T) more.
float ChannelMedia::loss_of_core(std::size_t core) const {
    constexpr float least_way = 0.5f;  // of a thin block, whose middle lies below the sheet
    const ViewingGrid& grid = parameters.grid;
    const std::array<float, 3>& edge = parameters.edge;
    const GridBlock& block = grid.blocks[grid.core_block[core]];
    const std::uint32_t medium = grid.core_medium[core];
    const float absorbed = 64 * parameters.volume * core_sigma_a[medium];
    if (!grid.is_on_sheet(block.at)) return absorbed;
    const float height = 4 * edge[2],
                depth = height + static_cast<float>(grid.corner_of(block.at)[2] * grid.pitch_mm[2]);
    const float returned = grid.backing == Backing::black ? 0 : media.core_sheet.empty() ? 1 : media.core_sheet[core];
    if (returned >= 1) return absorbed * depth / height;
    const float way = parameters.sheet_way + parameters.sheet_T_inverse * 4 * returned / (1 - returned) +
                      (depth - height / 2) / core_D[medium];
    return absorbed * depth / height + 16 * edge[0] * edge[1] / std::max(way, least_way);
}

}  // namespace voxtone::optics

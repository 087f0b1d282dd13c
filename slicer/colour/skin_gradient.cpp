// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/skin_gradient.h"

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>

#include "base/parallel.h"
#include "slicer/layers/block_mixtures.h"

namespace voxtone::slicer {

std::vector<float> skin_gradient(
    const PrintParts& parts, const SkinMap& map, const SkinVoxels* kept, std::size_t cells, std::size_t resins,
    const std::function<bool(const optics::AppearanceSequence::GradientVisitor&)>& visit_all,
    const Progress& progress) {
    constexpr double scale = 0x1p32;
    std::vector<std::int64_t> sum(cells * map.layers.size() * resins);
    const auto add = [&](const optics::ResinGradient& gradient, const std::array<int, 3>& voxel, std::size_t at) {
        if (at >= sum.size() / resins) return;  // core, clear
        std::array<float, halftone::max_resins> by_resin{};
        gradient.all_at(voxel, {by_resin.data(), resins});
        for (std::size_t r = 0; r < resins; ++r) {
            const auto units = static_cast<std::int64_t>(static_cast<double>(by_resin[r]) * scale);
            if (units != 0) std::atomic_ref(sum[at * resins + r]).fetch_add(units, std::memory_order_relaxed);
        }
    };
    const auto add_found = [&](const optics::ResinGradient& gradient, const optics::VoxelBox& box,
                               const ShellBlock& block, int row, int lane) {
        const std::array<int, 3> voxel{block.origin[0] + lane, block.origin[1] + row % block.size[1],
                                       block.origin[2] + row / block.size[1]};
        if (!box.holds(voxel)) return;
        const int i = row * ShellBlock::width + lane;
        const std::size_t at = map.at(block.triangle[i], block.u[i], block.v[i], block.distance_mm[i]);
        add(gradient, voxel, at);
    };
    const bool any = visit_all([&](const optics::ResinGradient& gradient, const optics::VoxelBox& box) {
        if (kept)
            return kept->for_each(
                box, [&](const std::array<int, 3>& voxel, std::uint32_t at) { add(gradient, voxel, at); }, progress);
        parts.for_each_block(
            box,
            [&](const ShellBlock& block) {
                for_each_shell_voxel(block, [&](int row, int lane) { add_found(gradient, box, block, row, lane); });
            },
            progress);
    });
    if (!any) return {};
    std::vector<float> out(sum.size());
    parallel_for(0, out.size(), 1 << 16,
                 [&](std::size_t i) { out[i] = static_cast<float>(static_cast<double>(sum[i]) / scale); });
    return out;
}

}  // namespace voxtone::slicer

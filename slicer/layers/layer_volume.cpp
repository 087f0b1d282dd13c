// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/layer_volume.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "base/contracts.h"
#include "base/error.h"
#include "base/machine_memory.h"

namespace voxtone::slicer {

namespace {

constexpr int edge = optics::ResinVolume::block_edge;

}  // namespace

void expect_volume_fits(const std::array<int, 3>& size, double bytes, std::uint64_t most_bytes) {
    if (bytes <= double(most_bytes)) return;
    throw ResourceError(fmt::format(
        "the volume of {} x {} x {} voxels needs about {}, more than the {} that are allowed for it; allow more "
        "(--memory), or predict a part of the print or a smaller print",
        size[0], size[1], size[2], memory_text(static_cast<std::uint64_t>(bytes)), memory_text(most_bytes)));
}

LayerVolume::LayerVolume(const LayerWindow& window, const std::array<double, 3>& pitch_mm,
                         const std::array<optics::Material, io::max_materials>& material_of, std::uint64_t memory_bytes)
    : window_(window), pitch_mm_(pitch_mm), material_of_(material_of), memory_bytes_(memory_bytes) {
    VOXTONE_EXPECT(window.size[0] >= 1 && window.size[1] >= 1 && window.size[2] >= 1);
    slabs_.resize(static_cast<std::size_t>((window.size[2] + edge - 1) / edge));
    for (std::size_t s = 0; s < slabs_.size(); ++s) {
        slabs_[s].missing = std::min(edge, window.size[2] - static_cast<int>(s) * edge);
        slabs_[s].layers.resize(static_cast<std::size_t>(slabs_[s].missing));
    }
}

std::array<optics::Material, io::max_materials> LayerVolume::same_materials() {
    std::array<optics::Material, io::max_materials> materials{};
    for (std::size_t m = 0; m < materials.size(); ++m) materials[m] = static_cast<optics::Material>(m);
    return materials;
}

void LayerVolume::add(int k, io::LayerRuns layer) {
    k -= window_.corner[2];
    if (k < 0 || k >= window_.size[2]) return;
    VOXTONE_EXPECT(layer.rows() == layer.height_px());
    VOXTONE_EXPECT(window_.corner[0] + window_.size[0] <= static_cast<int>(layer.width_px()) &&
                   window_.corner[1] + window_.size[1] <= static_cast<int>(layer.height_px()));
    Slab& slab = slabs_[static_cast<std::size_t>(k / edge)];
    std::vector<std::optional<io::LayerRuns>> layers;
    {
        const std::scoped_lock lock(mutex_);
        auto& place = slab.layers[static_cast<std::size_t>(k % edge)];
        VOXTONE_EXPECT(!place && slab.missing > 0);
        place = std::move(layer);
        if (--slab.missing > 0) return;
        layers = std::exchange(slab.layers, {});
    }
    slab.volume = build(layers);
    count_memory(slab.volume.memory_bytes());
}

void LayerVolume::count_memory(std::uint64_t bytes) {
    const std::scoped_lock lock(mutex_);
    used_bytes_ += bytes;
    ++slabs_done_;
    if (used_bytes_ > memory_bytes_)
        expect_volume_fits(window_.size, double(used_bytes_) * double(slabs_.size()) / double(slabs_done_),
                           memory_bytes_);
}

optics::ResinVolume LayerVolume::build(const std::vector<std::optional<io::LayerRuns>>& layers) const {
    const auto [width, height, ignored] = window_.size;
    optics::ResinVolumeBuilder builder({width, height, static_cast<int>(layers.size())}, pitch_mm_);
    std::vector<optics::Material> voxels;
    for (int y = 0; y < height; y += edge) {
        const int rows = std::min(edge, height - y);
        voxels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(rows) * layers.size());
        optics::Material* to = voxels.data();
        for (const auto& layer : layers)
            for (int row = y; row < y + rows; ++row, to += width) {
                // Columns [begin, end) of the layer are those of the window.
                const int begin = window_.corner[0], end = begin + width;
                int x = 0;
                for (const io::Run run :
                     layer->row(layer->height_px() - 1 - static_cast<std::uint32_t>(window_.corner[1] + row))) {
                    const int first = std::max(x, begin), last = std::min(x + int{run.length}, end);
                    if (first < last) std::fill(to + (first - begin), to + (last - begin), material_of_[run.material]);
                    x += run.length;
                    if (x >= end) break;
                }
            }
        builder.add_block_row(voxels);
    }
    return builder.finish();
}

optics::ResinVolume LayerVolume::finish() {
    std::vector<optics::ResinVolume> parts;
    for (Slab& slab : slabs_) {
        VOXTONE_EXPECT(slab.missing == 0);
        parts.push_back(std::move(slab.volume));
    }
    return optics::stacked(std::move(parts));
}

}  // namespace voxtone::slicer

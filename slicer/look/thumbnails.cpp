// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/thumbnails.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "io/pictures/picture_writer.h"
#include "io/report/layer_thumbnail.h"

namespace voxtone::slicer {

Thumbnails::Thumbnails(int first, int layers, const VoxelGrid& grid, std::vector<io::Rgb> palette)
    : first_(first), layers_(layers), count_(std::min(most, layers)), grid_(grid), palette_(std::move(palette)) {}

int Thumbnails::slot_of(int k) const {
    return static_cast<int>((std::int64_t(k - first_) * count_ + layers_ - 1) / layers_);
}

int Thumbnails::layer_of(int slot) const { return first_ + static_cast<int>(std::int64_t(slot) * layers_ / count_); }

void Thumbnails::offer(int k, const io::LayerRuns& layer) {
    if (layer_of(slot_of(k)) != k) return;
    constexpr std::uint32_t longest_px = 560;
    const io::LinearPicture picture =
        io::layer_thumbnail(layer, palette_, {grid_.pitch_mm.x(), grid_.pitch_mm.y()}, longest_px);
    const io::Picture8 codes = io::encode_transparent(picture);
    io::ReportLayer entry;
    entry.number = std::uint32_t(k);
    entry.height_mm = (k + 0.5) * grid_.pitch_mm.z();
    const double longest_mm = std::max(grid_.size[0] * grid_.pitch_mm.x(), grid_.size[1] * grid_.pitch_mm.y());
    entry.picture = {"", io::png_bytes(codes), codes.width_px, codes.height_px, longest_px / longest_mm};
    const std::scoped_lock lock(mutex_);
    entries_[k] = std::move(entry);
}

std::vector<io::ReportLayer> Thumbnails::take() {
    std::vector<io::ReportLayer> layers;
    for (auto& [k, entry] : std::exchange(entries_, {})) layers.push_back(std::move(entry));
    return layers;
}

}  // namespace voxtone::slicer

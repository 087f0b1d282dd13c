// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/stack_layers.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "io/layers/orient.h"

namespace voxtone::slicer {

namespace {

/// The columns [begin, begin + width) of a row, in the print's materials; the row is left open.
void push_columns(std::span<const io::Run> row, int begin, int width,
                  const std::array<io::Material, io::max_materials>& material_of, io::LayerRuns& out) {
    int i = -begin;
    for (const io::Run& run : row) {
        const int first = std::max(i, 0), last = std::min(i + int(run.length), width);
        if (last > first) out.push(static_cast<std::uint32_t>(last - first), material_of[run.material]);
        i += run.length;
    }
}

}  // namespace

StackLayers::StackLayers(std::shared_ptr<const io::StackReader> stack, StackBitmaps bitmaps, const VoxelGrid& grid)
    : stack_(std::move(stack)), bitmaps_(std::move(bitmaps)), grid_(grid) {}

LayerCounts StackLayers::make(int slab, int k_begin, int k_end, const LayerSink& sink) const {
    LayerCounts counts;
    Stopwatch watch;
    for (int k = std::max(slab, k_begin); k < std::min({slab + 1, k_end, grid_.size[2]}); ++k) {
        const auto index = static_cast<std::uint32_t>(bitmaps_.first_layer + k);
        const io::LayerRuns all = io::as_sliced(stack_->read(index, bitmaps_.palette), bitmaps_.orientation);
        const int width = grid_.size[0], height = grid_.size[1];
        if (int(all.width_px()) < bitmaps_.corner[0] + width || int(all.height_px()) < bitmaps_.corner[1] + height)
            throw InputError(
                fmt::format("{}: {} x {} px, and was larger when the stack was opened: it is being written",
                            stack_->layer_name(index), all.width_px(), all.height_px()));
        io::LayerRuns layer(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height));
        for (int j = height - 1; j >= 0; --j) {
            const auto row = all.row(all.height_px() - 1 - static_cast<std::uint32_t>(bitmaps_.corner[1] + j));
            push_columns(row, bitmaps_.corner[0], width, bitmaps_.material_of, layer);
            layer.end_row();
            for (const io::Run& run : layer.row(layer.rows() - 1))
                if (run.material != io::background) counts.body_voxels += run.length;
        }
        counts.runs_s += watch.lap();
        sink(k, layer);
        watch.lap();
    }
    return counts;
}

}  // namespace voxtone::slicer

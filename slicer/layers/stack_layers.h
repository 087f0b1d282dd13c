// SPDX-License-Identifier: GPL-3.0-or-later
//
// A finished stack as a part of a print: its voxels as they are, wherever it stands.
//
// Layers are read when they are asked for, one at a time: memory is a layer's runs.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "io/layers/manifest.h"
#include "io/layers/stack_reader.h"
#include "slicer/layers/layer_source.h"

namespace voxtone::slicer {

/// How a stack's bitmaps are read.
struct StackBitmaps {
    std::vector<io::Rgb> palette;                               ///< of the stack's materials
    std::array<io::Material, io::max_materials> material_of{};  ///< of the print, by the stack's own
    io::Orientation orientation;                                ///< of its bitmaps, undone
    std::array<int, 2> corner{};                                ///< of the part, along x and y of the stack
    int first_layer = 0;                                        ///< of the stack that is the part's lowest
};

class StackLayers final : public LayerSource {
public:
    /// `grid`: of the part, which lies within the stack.
    StackLayers(std::shared_ptr<const io::StackReader> stack, StackBitmaps bitmaps, const VoxelGrid& grid);

    [[nodiscard]] const VoxelGrid& grid() const override { return grid_; }
    [[nodiscard]] int slab_layers() const override { return 1; }
    /// Throws what StackReader::read throws, and InputError for a layer of another size than the stack's.
    LayerCounts make(int slab, int k_begin, int k_end, const LayerSink& sink) const override;

private:
    std::shared_ptr<const io::StackReader> stack_;
    StackBitmaps bitmaps_;
    VoxelGrid grid_;
};

}  // namespace voxtone::slicer

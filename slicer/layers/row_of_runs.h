// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "io/layers/layer_runs.h"
#include "slicer/solid/span_slab.h"
#include "slicer/surface/surface_shell.h"

namespace voxtone::slicer {

/// A voxel of a block that is core or air.
inline constexpr io::Material no_shell = 0xff;

/// Appends one row of voxels as runs: air outside the spans, in them core except where a near block says otherwise. The
/// row is left open. `blocks`: from the left; blocks(), column(b), shell(b) with a bit for each shell voxel, and
/// materials(b), `no_shell` where a voxel is none.
template <class Blocks>
void push_row(io::LayerRuns& layer, int width, std::span<const Span> spans, const Blocks& blocks, io::Material core) {
    int i = 0;
    std::size_t block = 0;
    for (const Span& span : spans) {
        layer.push(std::uint32_t(span.begin - i), io::background);
        i = span.begin;
        while (block < blocks.blocks() && blocks.column(block) + ShellBlock::width <= i) ++block;
        // A block may reach into the next span too, so it is not passed over before its end.
        for (std::size_t b = block; i < span.end && b < blocks.blocks() && blocks.column(b) < span.end; ++b) {
            if (blocks.shell(b) == 0) continue;
            const int begin = blocks.column(b);
            if (begin > i) layer.push(std::uint32_t(begin - i), core), i = begin;
            const int end = std::min(begin + ShellBlock::width, span.end);
            const io::Material* materials = blocks.materials(b);
            for (; i < end; ++i) {
                const io::Material material = materials[i - begin];
                layer.push(1, material == no_shell ? core : material);
            }
        }
        layer.push(std::uint32_t(span.end - i), core);
        i = span.end;
    }
    layer.push(std::uint32_t(width - i), io::background);
}

}  // namespace voxtone::slicer

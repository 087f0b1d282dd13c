// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "io/layers/layer_runs.h"
#include "slicer/solid/span_slab.h"
#include "slicer/surface/surface_shell.h"

namespace voxtone::slicer {

/// Appends the voxels [begin, end) of eight.
inline void push_of_eight(io::LayerRuns& layer, const io::Material* eight, int begin, int end) {
    static_assert(std::endian::native == std::endian::little && sizeof(io::Material) == 1 && ShellBlock::width == 8);
    constexpr std::uint64_t each = 0x0101010101010101;
    std::uint64_t materials;
    std::memcpy(&materials, eight, sizeof materials);
    materials >>= 8 * begin;
    for (int left = end - begin; left > 0;) {
        const auto material = static_cast<io::Material>(materials & 0xff);
        const std::uint64_t others = materials ^ (material * each);
        const int length = others == 0 ? left : std::min(left, __builtin_ctzll(others) / 8);
        layer.push(std::uint32_t(length), material);
        left -= length;
        if (left > 0) materials >>= 8 * length;
    }
}

/// Appends one row of voxels as runs: air outside the spans, in them core except where a near block says otherwise. The
/// row is left open. `blocks`: from the left; blocks(), column(b), is_core(b) where it has no others, and materials(b),
/// eight, core where a voxel is not of the shell.
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
            if (blocks.is_core(b)) continue;
            const int begin = blocks.column(b);
            if (begin > i) layer.push(std::uint32_t(begin - i), core), i = begin;
            const int end = std::min(begin + ShellBlock::width, span.end);
            push_of_eight(layer, blocks.materials(b), i - begin, end - begin);
            i = end;
        }
        layer.push(std::uint32_t(span.end - i), core);
        i = span.end;
    }
    layer.push(std::uint32_t(width - i), io::background);
}

}  // namespace voxtone::slicer

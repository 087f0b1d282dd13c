// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/diffused_layers.h"

#include <algorithm>
#include <memory>
#include <vector>

#include "base/stopwatch.h"
#include "halftone/screens/error_diffusion.h"
#include "slicer/layers/block_mixtures.h"

namespace voxtone::slicer {

namespace {

struct KeptBlock {
    std::array<int, 3> origin{}, size{};
    std::vector<std::uint8_t> shell;
    std::vector<halftone::CumulativeMixture> mixtures;  // in the order of for_each_shell_voxel
};

/// One layer in full: which voxels are shell, what they ask for, what they get. Rows from small y.
struct FullLayer {
    FullLayer(int width, int height)
        : mixtures(std::size_t(width) * std::size_t(height)), shell(mixtures.size()), resin(mixtures.size()) {}
    std::vector<halftone::CumulativeMixture> mixtures;
    std::vector<std::uint8_t> shell, resin;
};

void lay_out(const std::vector<KeptBlock>& blocks, int k, int width, FullLayer& layer) {
    std::fill(layer.shell.begin(), layer.shell.end(), std::uint8_t{0});
    for (const KeptBlock& block : blocks) {
        const halftone::CumulativeMixture* mixture = block.mixtures.data();
        const int begin = (k - block.origin[2]) * block.size[1];
        for (int row = 0; row < begin; ++row) mixture += __builtin_popcount(block.shell[std::size_t(row)]);
        for (int row = begin; row < begin + block.size[1]; ++row)
            for (unsigned bits = block.shell[std::size_t(row)]; bits != 0; bits &= bits - 1) {
                const std::size_t at = std::size_t(block.origin[1] + row - begin) * std::size_t(width) +
                                       std::size_t(block.origin[0] + __builtin_ctz(bits));
                layer.mixtures[at] = *mixture++;
                layer.shell[at] = 1;
            }
    }
}

void push_row(io::LayerRuns& out, int width, std::span<const Span> spans, const std::uint8_t* shell,
              const std::uint8_t* resin, io::Material core) {
    int i = 0;
    for (const Span& span : spans) {
        out.push(std::uint32_t(span.begin - i), io::background);
        for (i = span.begin; i < span.end;) {
            const std::uint8_t* next = std::find(shell + i, shell + span.end, std::uint8_t{1});
            out.push(std::uint32_t(next - (shell + i)), core);
            for (i = int(next - shell); i < span.end && shell[i]; ++i)
                out.push(1, static_cast<io::Material>(1 + resin[i]));
        }
    }
    out.push(std::uint32_t(width - i), io::background);
    out.end_row();
}

}  // namespace

LayerCounts make_diffused_layers(const LayerSources& sources, const MixtureSources& by_colour, int slab, int first,
                                 int last, const LayerSink& sink) {
    const VoxelGrid& grid = sources.solid.grid();
    const int width = grid.size[0], height = grid.size[1], block_depth = sources.shell.block_size()[2];
    halftone::ErrorDiffusionOptions options;
    options.pitch_mm = {grid.pitch_mm.x(), grid.pitch_mm.y(), grid.pitch_mm.z()};
    options.seed = by_colour.seed;
    halftone::ErrorDiffusion diffusion(width, height, static_cast<int>(by_colour.separation.resins()), options);
    const auto mixtures = std::make_unique<BlockMixtures>(sources);
    FullLayer full(width, height);
    io::LayerRuns runs{std::uint32_t(width), std::uint32_t(height)};
    LayerCounts counts;
    std::vector<KeptBlock> blocks;
    Stopwatch watch;
    // The errors of a layer come from the layers below it in the slab, wanted or not.
    const int slab_first = slab * halftone::ErrorDiffusion::slab_layers;
    for (int begin = slab_first; begin < last;) {
        const int bk = begin / block_depth, end = std::min((bk + 1) * block_depth, last);
        SpanSlab spans;
        LayerCounts of_part;
        body_voxels(sources, begin, end, first, spans, of_part);
        of_part.solid_s += watch.lap();
        blocks.clear();
        for (int bj = 0; bj < sources.shell.block_rows(); ++bj)
            sources.shell.for_each_block(bj, bk, spans, [&](const ShellBlock& block) {
                of_part.shell_s += watch.lap();
                const std::size_t count = mixtures->gather(block);
                of_part.colour_s += watch.lap();
                const halftone::CumulativeMixture* separated = mixtures->separate();
                blocks.push_back({block.origin,
                                  block.size,
                                  {block.shell, block.shell + block.size[1] * block.size[2]},
                                  {separated, separated + count}});
                of_part.shell_voxels += count;
                of_part.screen_s += watch.lap();
            });
        of_part.shell_s += watch.lap();
        for (int k = begin; k < end; ++k) {
            lay_out(blocks, k, width, full);
            diffusion.layer(k, full.mixtures, full.shell, full.resin);
            of_part.screen_s += watch.lap();
            if (k < first) continue;
            runs.clear();
            for (int j = height - 1; j >= 0; --j) {
                const std::size_t row = std::size_t(j) * std::size_t(width);
                push_row(runs, width, spans.row(j, k), full.shell.data() + row, full.resin.data() + row, sources.core);
            }
            of_part.runs_s += watch.lap();
            sink(k, runs);
            watch.lap();
        }
        counts += of_part;
        begin = end;
    }
    return counts;
}

}  // namespace voxtone::slicer

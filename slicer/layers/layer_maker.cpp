// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/layer_maker.h"

#include <algorithm>
#include <memory>
#include <vector>

#include "base/contracts.h"
#include "base/stopwatch.h"
#include "halftone/screens/error_diffusion.h"
#include "slicer/layers/block_mixtures.h"
#include "slicer/layers/diffused_layers.h"
#include "slicer/layers/row_of_runs.h"
#include "slicer/layers/screened_slab.h"

namespace voxtone::slicer {

namespace {

constexpr int block_width = ShellBlock::width;

/// The near blocks of one row of blocks: which columns they stand in, and for each of their voxels the material, core
/// where it is not of the shell.
class Strip {
public:
    void reset(int rows, io::Material core) {
        rows_ = rows;
        core_ = core;
        columns_.clear();
        materials_.clear();
        shell_.clear();
    }
    /// Appends a block that begins at column `i` and returns its materials, row-major, eight to a row.
    io::Material* append(int i, const std::uint8_t* shell) {
        columns_.push_back(i);
        shell_.insert(shell_.end(), shell, shell + rows_);
        materials_.resize(materials_.size() + std::size_t(rows_) * block_width, core_);
        return materials_.data() + (columns_.size() - 1) * std::size_t(rows_) * block_width;
    }
    [[nodiscard]] std::size_t blocks() const { return columns_.size(); }
    [[nodiscard]] int column(std::size_t block) const { return columns_[block]; }
    [[nodiscard]] std::uint8_t shell(std::size_t block, int row) const {
        return shell_[block * std::size_t(rows_) + std::size_t(row)];
    }
    [[nodiscard]] const io::Material* materials(std::size_t block, int row) const {
        return materials_.data() + (block * std::size_t(rows_) + std::size_t(row)) * block_width;
    }

private:
    int rows_ = 0;
    io::Material core_ = io::background;
    std::vector<int> columns_;
    std::vector<std::uint8_t> shell_;
    std::vector<io::Material> materials_;
};

/// One row of voxels of a strip.
class StripRow {
public:
    StripRow(const Strip& strip, int row) : strip_(strip), row_(row) {}
    [[nodiscard]] std::size_t blocks() const { return strip_.blocks(); }
    [[nodiscard]] int column(std::size_t b) const { return strip_.column(b); }
    [[nodiscard]] bool is_core(std::size_t b) const { return strip_.shell(b, row_) == 0; }
    [[nodiscard]] const io::Material* materials(std::size_t b) const { return strip_.materials(b, row_); }

private:
    const Strip& strip_;
    int row_;
};

bool shows_core_only(const LayerSources& s) {
    if (s.surface.triangles.empty()) return true;
    if (s.zones.any()) return false;
    if (s.core_only) return true;
    const auto* by_colour = std::get_if<MixtureSources>(&s.resins);
    if (!by_colour || by_colour->skin || !by_colour->colour.constant() || by_colour->translucent.kept) return false;
    const Eigen::Vector3f rgb = by_colour->colour.at(s.surface.source_triangle[0], 0, 0);
    halftone::CumulativeMixture mixture;
    by_colour->separation.mixtures(&rgb.x(), &rgb.y(), &rgb.z(), 1, &mixture);
    const int resins = static_cast<int>(by_colour->separation.resins());
    const int first = halftone::select_resin(mixture, 0, resins), last = halftone::select_resin(mixture, 65534, resins);
    return first == last && first + 1 == s.core;
}

}  // namespace

LayerMaker::LayerMaker(const LayerSources& sources) : sources_(sources), all_core_(shows_core_only(sources)) {
    VOXTONE_EXPECT(sources.core > 0 && sources.core < io::max_materials);
    if (const auto* by_colour = std::get_if<MixtureSources>(&sources.resins))
        VOXTONE_EXPECT(by_colour->separation.resins() < io::max_materials);
}

bool LayerMaker::by_blocks() const {
    const auto* by_colour = std::get_if<MixtureSources>(&sources_.resins);
    return !by_colour || by_colour->screen || sources_.core_only;
}

std::unique_ptr<BlockFill> LayerMaker::block_fill() const {
    if (const auto* other = std::get_if<const ShellFill*>(&sources_.resins)) return (*other)->block_fill();
    const auto& s = std::get<MixtureSources>(sources_.resins);
    if (sources_.core_only) return std::make_unique<BareCore>(sources_.zones, sources_.core);
    if (!s.screen) return nullptr;
    return std::make_unique<ScreenedMixtures>(sources_);
}

int LayerMaker::slab_layers() const {
    return by_blocks() ? sources_.shell.block_size()[2] : halftone::ErrorDiffusion::slab_layers;
}

LayerCounts LayerMaker::make(int slab, int k_begin, int k_end, const LayerSink& sink) const {
    const int first = std::max(k_begin, slab * slab_layers());
    const int last = std::min({k_end, (slab + 1) * slab_layers(), sources_.solid.grid().size[2]});
    if (first >= last) return {};
    if (by_blocks() || all_core_) return make_screened(slab, first, last, sink);
    return make_diffused_layers(sources_, std::get<MixtureSources>(sources_.resins), slab, first, last, sink);
}

std::unique_ptr<const SlabLayers> LayerMaker::slab_layers_of(int slab, int k_begin, int k_end,
                                                             std::span<const std::array<int, 3>> places,
                                                             LayerCounts& counts) const {
    const auto* by_colour = std::get_if<MixtureSources>(&sources_.resins);
    if (all_core_ || !by_colour || !by_colour->screen)
        return LayerSource::slab_layers_of(slab, k_begin, k_end, places, counts);
    const int first = std::max(k_begin, slab * slab_layers());
    const int last = std::min({k_end, (slab + 1) * slab_layers(), sources_.solid.grid().size[2]});
    return std::make_unique<ScreenedSlab>(sources_, slab, first, std::max(first, last), places, counts);
}

LayerCounts LayerMaker::make_screened(int slab, int first, int last, const LayerSink& sink) const {
    const VoxelGrid& grid = sources_.solid.grid();
    LayerCounts counts;
    Stopwatch watch;
    SpanSlab spans;
    body_voxels(sources_, first, last, first, spans, counts);
    counts.solid_s += watch.lap();

    std::vector<io::LayerRuns> layers(std::size_t(last - first),
                                      io::LayerRuns(std::uint32_t(grid.size[0]), std::uint32_t(grid.size[1])));
    const int block_height = sources_.shell.block_size()[1], block_depth = sources_.shell.block_size()[2];
    const std::unique_ptr<BlockFill> fill = all_core_ ? nullptr : block_fill();
    Strip strip;
    for (int bj = sources_.shell.block_rows() - 1; bj >= 0; --bj) {
        strip.reset(block_height * block_depth, sources_.core);
        if (!all_core_)
            sources_.shell.for_each_block(bj, slab, spans, [&](const ShellBlock& block) {
                VOXTONE_DEBUG_EXPECT(block.size[1] == block_height && block.size[2] == block_depth);
                counts.shell_s += watch.lap();
                fill->fill(block, strip.append(block.origin[0], block.shell), counts);
                watch.lap();
            });
        counts.shell_s += watch.lap();
        for (int k = first; k < last; ++k)
            for (int j = std::min((bj + 1) * block_height, grid.size[1]) - 1; j >= bj * block_height; --j) {
                const int row = all_core_ ? 0 : (k - slab * block_depth) * block_height + (j - bj * block_height);
                push_row(layers[std::size_t(k - first)], grid.size[0], spans.row(j, k), StripRow(strip, row),
                         sources_.core);
                layers[std::size_t(k - first)].end_row();
            }
        counts.runs_s += watch.lap();
    }
    for (int k = first; k < last; ++k) sink(k, layers[std::size_t(k - first)]);
    return counts;
}

}  // namespace voxtone::slicer

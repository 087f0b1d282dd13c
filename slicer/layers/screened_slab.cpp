// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/screened_slab.h"

#include <array>
#include <variant>

#include "base/stopwatch.h"
#include "slicer/layers/block_mixtures.h"
#include "slicer/layers/row_of_runs.h"

namespace voxtone::slicer {

/// The blocks of one row of voxels with their resins.
class ScreenedSlab::ScreenedRow {
public:
    ScreenedRow(const ScreenedSlab& slab, const std::vector<Block>& blocks, std::size_t row, int j, int k,
                const std::array<int, 3>& at)
        : slab_(slab), blocks_(blocks), row_(row), at_(at[0]), thresholds_(slab.screen_.row(j + at[1], k + at[2])) {}

    [[nodiscard]] std::size_t blocks() const { return blocks_.size(); }
    [[nodiscard]] int column(std::size_t b) const { return blocks_[b].column; }
    [[nodiscard]] std::uint8_t shell(std::size_t b) const { return slab_.shell_[blocks_[b].rows + row_]; }
    /// Until it is called again.
    [[nodiscard]] const io::Material* materials(std::size_t b) const {
        materials_.fill(no_shell);
        const halftone::CumulativeMixture* mixture =
            slab_.mixture_.data() + slab_.first_mixture_[blocks_[b].rows + row_];
        for (unsigned bits = shell(b); bits != 0; bits &= bits - 1) {
            const int lane = __builtin_ctz(bits);
            const std::uint16_t threshold =
                thresholds_[(blocks_[b].column + lane + at_) & halftone::BlueNoiseScreen::mask];
            materials_[static_cast<std::size_t>(lane)] =
                static_cast<io::Material>(1 + halftone::select_resin(*mixture++, threshold, slab_.resins_));
        }
        return materials_.data();
    }

private:
    const ScreenedSlab& slab_;
    const std::vector<Block>& blocks_;
    std::size_t row_;
    int at_;
    const std::uint16_t* thresholds_;
    mutable std::array<io::Material, ShellBlock::width> materials_{};
};

ScreenedSlab::ScreenedSlab(const LayerSources& sources, int slab, int first, int last, LayerCounts& counts)
    : screen_(*std::get<MixtureSources>(sources.resins).screen),
      resins_(static_cast<int>(std::get<MixtureSources>(sources.resins).separation.resins())),
      width_(sources.solid.grid().size[0]),
      slab_(slab),
      block_height_(sources.shell.block_size()[1]),
      block_depth_(sources.shell.block_size()[2]),
      core_(sources.core),
      blocks_(static_cast<std::size_t>(sources.shell.block_rows())) {
    Stopwatch watch;
    body_voxels(sources, first, last, first, spans_, counts);
    counts.solid_s += watch.lap();
    const auto& by_colour = std::get<MixtureSources>(sources.resins);
    BlockMixtures mixtures(sources.surface, by_colour.colour, by_colour.separation, by_colour.skin);
    const int rows = block_height_ * block_depth_;
    for (int bj = 0; bj < sources.shell.block_rows(); ++bj) {
        sources.shell.for_each_block(bj, slab, spans_, [&](const ShellBlock& block) {
            counts.shell_s += watch.lap();
            const std::size_t count = mixtures.gather(block);
            counts.shell_voxels += count;
            const halftone::CumulativeMixture* found = mixtures.separate();
            blocks_[static_cast<std::size_t>(bj)].push_back({block.origin[0], shell_.size()});
            auto next = static_cast<std::uint32_t>(mixture_.size());
            mixture_.insert(mixture_.end(), found, found + count);
            for (int row = 0; row < rows; ++row) {
                shell_.push_back(block.shell[row]);
                first_mixture_.push_back(next);
                next += static_cast<std::uint32_t>(__builtin_popcount(block.shell[row]));
            }
            counts.colour_s += watch.lap();
        });
        counts.shell_s += watch.lap();
    }
}

void ScreenedSlab::push_row(int j, int k, const std::array<int, 3>& at, io::LayerRuns& out) const {
    const int bj = j / block_height_;
    const auto row = static_cast<std::size_t>((k - slab_ * block_depth_) * block_height_ + (j - bj * block_height_));
    const std::vector<Block>& blocks = blocks_[static_cast<std::size_t>(bj)];
    slicer::push_row(out, width_, spans_.row(j, k), ScreenedRow(*this, blocks, row, j, k, at), core_);
}

}  // namespace voxtone::slicer

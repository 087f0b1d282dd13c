// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/screened_slab.h"

#include <algorithm>
#include <variant>

#include "base/contracts.h"
#include "base/stopwatch.h"
#include "slicer/layers/block_mixtures.h"
#include "slicer/layers/row_of_runs.h"

namespace voxtone::slicer {

namespace {

/// Places up to which a byte a voxel for each is less than their mixtures.
constexpr std::size_t few_places = 8;

}  // namespace

/// A row of blocks, block by block and in each row by row of voxels.
class ScreenedSlab::BlockRow {
public:
    BlockRow(const ScreenedSlab& slab, int block_rows) : slab_(slab), rows_(std::size_t(block_rows)) {}
    void clear() {
        columns_.clear();
        shell_.clear();
        mixture_.clear();
        resins_.clear();
    }
    /// `mixture`: of its voxels of the shell, row by row.
    void append(const ShellBlock& block, const halftone::CumulativeMixture* mixture) {
        columns_.push_back(block.origin[0]);
        shell_.insert(shell_.end(), block.shell, block.shell + rows_);
        const std::size_t first = (columns_.size() - 1) * rows_;
        mixture_.resize(mixture_.size() + (slab_.keeps_mixtures() ? rows_ * slab_.bounds_ : 0));
        resins_.resize(resins_.size() + rows_ * slab_.resins_of_.size());
        for (std::size_t row = 0; row < rows_; ++row) {
            if (block.shell[row] == 0) continue;
            if (slab_.keeps_mixtures())
                keep(block.shell[row], mixture, mixture_.data() + (first + row) * slab_.bounds_);
            else
                screen(block, row, mixture, resins_.data() + (first + row) * slab_.resins_of_.size());
            mixture += __builtin_popcount(block.shell[row]);
        }
    }
    [[nodiscard]] std::size_t blocks() const { return columns_.size(); }
    [[nodiscard]] int column(std::size_t block) const { return columns_[block]; }
    [[nodiscard]] std::uint8_t shell(std::size_t block, std::size_t row) const { return shell_[block * rows_ + row]; }
    [[nodiscard]] const Bounds* mixture(std::size_t block, std::size_t row) const {
        return mixture_.data() + (block * rows_ + row) * slab_.bounds_;
    }
    [[nodiscard]] const Eight& resins(std::size_t block, std::size_t row, std::size_t place) const {
        return resins_[(block * rows_ + row) * slab_.resins_of_.size() + place];
    }

private:
    void keep(unsigned shell, const halftone::CumulativeMixture* mixture, Bounds* to) const {
        for (unsigned bits = shell; bits != 0; bits &= bits - 1, ++mixture)
            for (std::size_t bound = 0; bound < slab_.bounds_; ++bound)
                to[bound][std::size_t(__builtin_ctz(bits))] = mixture->bound[bound];
    }
    void screen(const ShellBlock& block, std::size_t row, const halftone::CumulativeMixture* mixture, Eight* to) const {
        const int j = block.origin[1] + int(row) % block.size[1], k = block.origin[2] + int(row) / block.size[1];
        const int resins = int(slab_.bounds_) + 1;
        for (const std::array<int, 3>& at : slab_.places_) {
            const std::uint16_t* thresholds = slab_.screen_.row(j + at[1], k + at[2]);
            const halftone::CumulativeMixture* next = mixture;
            to->fill(slab_.core_);
            for (unsigned bits = block.shell[row]; bits != 0; bits &= bits - 1) {
                const int lane = __builtin_ctz(bits);
                (*to)[std::size_t(lane)] = io::Material(
                    1 + halftone::select_resin(
                            *next++, thresholds[(block.origin[0] + lane + at[0]) & halftone::BlueNoiseScreen::mask],
                            resins));
            }
            ++to;
        }
    }

    const ScreenedSlab& slab_;
    std::size_t rows_;
    std::vector<int> columns_;
    std::vector<std::uint8_t> shell_;
    std::vector<Bounds> mixture_;
    std::vector<Eight> resins_;
};

/// The pieces of one row of voxels with their resins.
class ScreenedSlab::Pieces {
public:
    Pieces(const ScreenedSlab& slab, std::size_t row, int j, int k, const std::array<int, 3>& at)
        : slab_(slab), first_(slab.row_begin_[row]), count_(slab.row_begin_[row + 1] - first_), at_(at[0]) {
        if (!slab.keeps_mixtures()) {
            resins_ = slab.resins_of_[slab.place_of(at)].data() + first_;
            return;
        }
        // As long again as a piece, so that each has its thresholds side by side.
        const std::uint16_t* thresholds = slab.screen_.row(j + at[1], k + at[2]);
        std::copy_n(thresholds, halftone::BlueNoiseScreen::size, thresholds_.begin());
        std::copy_n(thresholds, lanes, thresholds_.begin() + halftone::BlueNoiseScreen::size);
    }

    [[nodiscard]] std::size_t blocks() const { return count_; }
    [[nodiscard]] int column(std::size_t b) const { return slab_.column_[first_ + b]; }
    [[nodiscard]] static bool is_core(std::size_t) { return false; }
    /// Until it is called again.
    [[nodiscard]] const io::Material* materials(std::size_t b) const {
        if (resins_) return resins_[b].data();
        const std::uint16_t* threshold = thresholds_.data() + ((column(b) + at_) & halftone::BlueNoiseScreen::mask);
        const Bounds* bound = slab_.mixture_.data() + (first_ + b) * slab_.bounds_;
        std::array<std::uint16_t, lanes> material;
        material.fill(1);
        for (std::size_t n = 0; n < slab_.bounds_; ++n)
            for (std::size_t lane = 0; lane < lanes; ++lane)
                material[lane] = std::uint16_t(material[lane] + (threshold[lane] >= bound[n][lane] ? 1 : 0));
        const unsigned shell = slab_.shell_[first_ + b];
        for (std::size_t lane = 0; lane < lanes; ++lane)
            screened_[lane] = shell >> lane & 1 ? io::Material(material[lane]) : slab_.core_;
        return screened_.data();
    }

private:
    const ScreenedSlab& slab_;
    std::size_t first_, count_;
    int at_;
    const Eight* resins_ = nullptr;
    std::array<std::uint16_t, halftone::BlueNoiseScreen::size + lanes> thresholds_;
    mutable Eight screened_;
};

ScreenedSlab::ScreenedSlab(const LayerSources& sources, int slab, int first, int last,
                           std::span<const std::array<int, 3>> places, LayerCounts& counts)
    : screen_(*std::get<MixtureSources>(sources.resins).screen),
      width_(sources.solid.grid().size[0]),
      rows_(sources.solid.grid().size[1]),
      block_height_(sources.shell.block_size()[1]),
      first_(first),
      layers_(last - first),
      bounds_(std::get<MixtureSources>(sources.resins).separation.resins() - 1),
      core_(sources.core),
      places_(places.begin(), places.end()),
      row_begin_{0} {
    VOXTONE_EXPECT(!places.empty());
    if (places.size() <= few_places) resins_of_.resize(places.size());
    Stopwatch watch;
    body_voxels(sources, first, last, first, spans_, counts);
    counts.solid_s += watch.lap();
    row_begin_.reserve(std::size_t(rows_) * std::size_t(layers_) + 1);
    BlockMixtures mixtures(sources);
    const int block_depth = sources.shell.block_size()[2];
    BlockRow blocks(*this, block_height_ * block_depth);
    for (int bj = 0; bj < sources.shell.block_rows(); ++bj) {
        blocks.clear();
        sources.shell.for_each_block(bj, slab, spans_, [&](const ShellBlock& block) {
            counts.shell_s += watch.lap();
            counts.shell_voxels += mixtures.gather(block);
            const halftone::CumulativeMixture* found = mixtures.separate();
            counts.colour_s += watch.lap();
            blocks.append(block, found);
            counts.screen_s += watch.lap();
        });
        counts.shell_s += watch.lap();
        add_block_row(bj, slab * block_depth, blocks);
        counts.screen_s += watch.lap();
    }
}

void ScreenedSlab::add_block_row(int bj, int bottom, const BlockRow& blocks) {
    const int height = std::min(block_height_, rows_ - bj * block_height_);
    for (int k = first_; k < first_ + layers_; ++k)
        for (int j = 0; j < height; ++j) {
            const auto row = std::size_t((k - bottom) * block_height_ + j);
            for (std::size_t b = 0; b < blocks.blocks(); ++b) {
                if (blocks.shell(b, row) == 0) continue;
                column_.push_back(blocks.column(b));
                if (keeps_mixtures()) {
                    shell_.push_back(blocks.shell(b, row));
                    mixture_.insert(mixture_.end(), blocks.mixture(b, row), blocks.mixture(b, row) + bounds_);
                }
                for (std::size_t place = 0; place < resins_of_.size(); ++place)
                    resins_of_[place].push_back(blocks.resins(b, row, place));
            }
            row_begin_.push_back(std::uint32_t(column_.size()));
        }
}

std::size_t ScreenedSlab::place_of(const std::array<int, 3>& at) const {
    const auto place = std::ranges::find(places_, at);
    VOXTONE_EXPECT(place != places_.end());
    return std::size_t(place - places_.begin());
}

void ScreenedSlab::push_row(int j, int k, const std::array<int, 3>& at, io::LayerRuns& out) const {
    // Rows lie block row by block row, in each layer by layer.
    const int bj = j / block_height_, below = bj * block_height_, height = std::min(block_height_, rows_ - below);
    const auto row = std::size_t(below * layers_ + (k - first_) * height + (j - below));
    slicer::push_row(out, width_, spans_.row(j, k), Pieces(*this, row, j, k, at), core_);
}

std::size_t ScreenedSlab::memory_bytes() const {
    std::size_t bytes = row_begin_.capacity() * sizeof row_begin_[0] + column_.capacity() * sizeof column_[0] +
                        shell_.capacity() + mixture_.capacity() * sizeof mixture_[0];
    for (const std::vector<Eight>& resins : resins_of_) bytes += resins.capacity() * sizeof resins[0];
    return bytes;
}

}  // namespace voxtone::slicer

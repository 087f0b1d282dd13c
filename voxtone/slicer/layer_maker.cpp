// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/layer_maker.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <vector>

#include "voxtone/base/contracts.h"

namespace voxtone::slicer {

namespace {

constexpr int block_width = ShellBlock::width;
constexpr io::Material no_shell = 0xff;

/// Seconds since the last call (or since it was made).
class Lap {
public:
    double operator()() {
        const auto now = std::chrono::steady_clock::now();
        const double seconds = std::chrono::duration<double>(now - last_).count();
        last_ = now;
        return seconds;
    }

private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// The near blocks of one row of blocks: which columns they stand in, and for each of their voxels the material, or
/// `no_shell` where the voxel is core or air.
class Strip {
public:
    void reset(int rows) {
        rows_ = rows;
        columns_.clear();
        materials_.clear();
        shell_.clear();
    }
    /// Appends a block that begins at column `i` and returns its materials, row-major, eight to a row.
    io::Material* append(int i, const std::uint8_t* shell) {
        columns_.push_back(i);
        shell_.insert(shell_.end(), shell, shell + rows_);
        materials_.resize(materials_.size() + std::size_t(rows_) * block_width, no_shell);
        return materials_.data() + (columns_.size() - 1) * std::size_t(rows_) * block_width;
    }
    [[nodiscard]] std::size_t blocks() const { return columns_.size(); }
    [[nodiscard]] int column(std::size_t block) const { return columns_[block]; }
    [[nodiscard]] std::uint8_t shell(std::size_t block, int row) const { return shell_[block * std::size_t(rows_) + std::size_t(row)]; }
    [[nodiscard]] const io::Material* materials(std::size_t block, int row) const {
        return materials_.data() + (block * std::size_t(rows_) + std::size_t(row)) * block_width;
    }

private:
    int rows_ = 0;
    std::vector<int> columns_;
    std::vector<std::uint8_t> shell_;
    std::vector<io::Material> materials_;
};

/// One row of voxels as runs: air outside the spans, in them core except where a near block says otherwise.
void push_row(io::LayerRuns& layer, int width, std::span<const Span> spans, const Strip& strip, int strip_row, io::Material core) {
    int i = 0;
    std::size_t block = 0;
    for (const Span& span : spans) {
        layer.push(std::uint32_t(span.begin - i), io::background);
        i = span.begin;
        while (block < strip.blocks() && strip.column(block) + block_width <= i) ++block;
        // A block may reach into the next span too, so it is not passed over before its end.
        for (std::size_t b = block; i < span.end && b < strip.blocks() && strip.column(b) < span.end; ++b) {
            if (strip.shell(b, strip_row) == 0) continue;
            const int begin = strip.column(b);
            if (begin > i) layer.push(std::uint32_t(begin - i), core), i = begin;
            const int end = std::min(begin + block_width, span.end);
            const io::Material* materials = strip.materials(b, strip_row);
            for (; i < end; ++i) {
                const io::Material material = materials[i - begin];
                layer.push(1, material == no_shell ? core : material);
            }
        }
        layer.push(std::uint32_t(span.end - i), core);
        i = span.end;
    }
    layer.push(std::uint32_t(width - i), io::background);
    layer.end_row();
}

/// Colours the shell voxels of one block.
class BlockColourist {
public:
    explicit BlockColourist(const LayerSources& sources) : s_(sources), resins_(static_cast<int>(sources.separation.resins())) {}

    void colour(const ShellBlock& block, io::Material* out, Lap& lap, LayerCounts& counts) {
        gather(block);
        counts.shell_voxels += std::uint64_t(count_);
        counts.colour_s += lap();
        s_.separation.mixtures(red_.data(), green_.data(), blue_.data(), static_cast<std::size_t>(count_), mixture_.data());
        constexpr int mask = halftone::BlueNoiseScreen::mask;
        int n = 0;
        for (int row = 0; row < block.size[1] * block.size[2]; ++row) {
            if (block.shell[row] == 0) continue;
            const std::uint16_t* thresholds =
                s_.screen.row(block.origin[1] + row % block.size[1], block.origin[2] + row / block.size[1]);
            for (unsigned bits = block.shell[row]; bits != 0; bits &= bits - 1) {
                const int lane = __builtin_ctz(bits);
                const std::uint16_t threshold = thresholds[(block.origin[0] + lane) & mask];
                out[row * block_width + lane] =
                    static_cast<io::Material>(1 + halftone::select_resin(mixture_[std::size_t(n++)], threshold, resins_));
            }
        }
        counts.screen_s += lap();
    }

private:
    void gather(const ShellBlock& block) {
        count_ = 0;
        for (int row = 0; row < block.size[1] * block.size[2]; ++row)
            for (unsigned bits = block.shell[row]; bits != 0; bits &= bits - 1) {
                const int at = row * block_width + __builtin_ctz(bits);
                const Eigen::Vector3f rgb = s_.colour.at(s_.surface.source_triangle[block.triangle[at]], block.u[at], block.v[at]);
                red_[std::size_t(count_)] = rgb.x();
                green_[std::size_t(count_)] = rgb.y();
                blue_[std::size_t(count_)] = rgb.z();
                ++count_;
            }
    }

    static constexpr std::size_t max_voxels = std::size_t(ShellBlock::max_rows) * block_width;
    const LayerSources& s_;
    int resins_;
    int count_ = 0;
    std::array<float, max_voxels> red_, green_, blue_;
    std::array<halftone::CumulativeMixture, max_voxels> mixture_;
};

bool shows_core_only(const LayerSources& s) {
    if (!s.colour.constant() || s.surface.triangles.empty()) return s.surface.triangles.empty();
    const Eigen::Vector3f rgb = s.colour.at(s.surface.source_triangle[0], 0, 0);
    halftone::CumulativeMixture mixture;
    s.separation.mixtures(&rgb.x(), &rgb.y(), &rgb.z(), 1, &mixture);
    const int resins = static_cast<int>(s.separation.resins());
    const int first = halftone::select_resin(mixture, 0, resins), last = halftone::select_resin(mixture, 65534, resins);
    return first == last && first + 1 == s.core;
}

}  // namespace

LayerCounts& LayerCounts::operator+=(const LayerCounts& other) {
    body_voxels += other.body_voxels;
    shell_voxels += other.shell_voxels;
    thin_voxels += other.thin_voxels;
    solid_s += other.solid_s;
    shell_s += other.shell_s;
    colour_s += other.colour_s;
    screen_s += other.screen_s;
    runs_s += other.runs_s;
    return *this;
}

LayerMaker::LayerMaker(const LayerSources& sources) : sources_(sources), all_core_(shows_core_only(sources)) {
    VOXTONE_EXPECT(sources.core > 0 && sources.core < no_shell);
    VOXTONE_EXPECT(sources.separation.resins() < no_shell);
}

LayerCounts LayerMaker::make(int slab, int k_begin, int k_end,
                             const std::function<void(int, const io::LayerRuns&)>& sink) const {
    const VoxelGrid& grid = sources_.solid.grid();
    const int first = std::max(k_begin, slab * slab_layers());
    const int last = std::min({k_end, (slab + 1) * slab_layers(), grid.size[2]});
    LayerCounts counts;
    if (first >= last) return counts;

    Lap lap;
    SpanSlab body;
    sources_.solid.slab(first, last, body);
    counts.solid_s = lap();

    std::vector<io::LayerRuns> layers(std::size_t(last - first),
                                      io::LayerRuns(std::uint32_t(grid.size[0]), std::uint32_t(grid.size[1])));
    const int block_height = sources_.shell.block_size()[1], block_depth = sources_.shell.block_size()[2];
    const auto colourist = std::make_unique<BlockColourist>(sources_);
    Strip strip;
    for (int bj = sources_.shell.block_rows() - 1; bj >= 0; --bj) {
        strip.reset(block_height * block_depth);
        if (!all_core_)
            sources_.shell.for_each_block(bj, slab, body, [&](const ShellBlock& block) {
                VOXTONE_DEBUG_EXPECT(block.size[1] == block_height && block.size[2] == block_depth);
                counts.shell_s += lap();
                colourist->colour(block, strip.append(block.origin[0], block.shell), lap, counts);
            });
        counts.shell_s += lap();
        for (int k = first; k < last; ++k)
            for (int j = std::min((bj + 1) * block_height, grid.size[1]) - 1; j >= bj * block_height; --j)
                push_row(layers[std::size_t(k - first)], grid.size[0], body.row(j, k), strip,
                         (k - slab * block_depth) * block_height + (j - bj * block_height), sources_.core);
        counts.runs_s += lap();
    }
    for (int k = first; k < last; ++k) {
        counts.body_voxels += body.voxels_of_layer(k);
        sink(k, layers[std::size_t(k - first)]);
    }
    return counts;
}

}  // namespace voxtone::slicer

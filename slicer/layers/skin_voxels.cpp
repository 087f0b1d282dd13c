// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/skin_voxels.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <tuple>
#include <utility>

#include "base/contracts.h"
#include "base/parallel.h"

namespace voxtone::slicer {

namespace {

constexpr int volume_edge = optics::ResinVolume::block_edge;
constexpr int row_width = ShellBlock::width;
static_assert(volume_edge % row_width == 0 && volume_edge == 16);

/// Of a piece within its block of the volume.
struct PieceHead {
    std::uint8_t x, y, z, rows, layers;
};

void append_number(std::vector<std::uint8_t>& bytes, std::uint32_t number) {
    std::array<std::uint8_t, sizeof number> raw;
    std::memcpy(raw.data(), &number, sizeof number);
    bytes.insert(bytes.end(), raw.begin(), raw.end());
}

}  // namespace

/// Cuts shell blocks where blocks of the volume end, and appends the pieces to a slab's bytes.
class SkinVoxels::Writer {
public:
    Writer(const std::array<int, 3>& blocks, std::uint16_t slab, std::vector<std::uint8_t>& bytes,
           std::vector<Piece>& pieces)
        : blocks_(blocks), slab_(slab), bytes_(bytes), pieces_(pieces) {}

    void add(const ShellBlock& block, const NumberOf& number_of) {
        for (int z = 0; z < block.size[2];) {
            const int z_end = end_of_piece(block.origin[2], z, block.size[2]);
            for (int y = 0; y < block.size[1];) {
                const int y_end = end_of_piece(block.origin[1], y, block.size[1]);
                add_piece(block, {y, y_end}, {z, z_end}, number_of);
                y = y_end;
            }
            z = z_end;
        }
    }

private:
    using Range = std::pair<int, int>;
    static int end_of_piece(int origin, int at, int size) {
        return std::min(size, ((origin + at) / volume_edge + 1) * volume_edge - origin);
    }

    void add_piece(const ShellBlock& block, Range y, Range z, const NumberOf& number_of) {
        const int first_y = block.origin[1] + y.first, first_z = block.origin[2] + z.first;
        const std::array<int, 3> at{block.origin[0] / volume_edge, first_y / volume_edge, first_z / volume_edge};
        // The last shell blocks reach beyond the volume, where no voxel is.
        if (at[0] >= blocks_[0] || at[1] >= blocks_[1] || at[2] >= blocks_[2]) return;
        const std::size_t begin = bytes_.size();
        const PieceHead head{
            static_cast<std::uint8_t>(block.origin[0] % volume_edge), static_cast<std::uint8_t>(first_y % volume_edge),
            static_cast<std::uint8_t>(first_z % volume_edge), static_cast<std::uint8_t>(y.second - y.first),
            static_cast<std::uint8_t>(z.second - z.first)};
        bytes_.insert(bytes_.end(), {head.x, head.y, head.z, head.rows, head.layers});
        for (auto& row : below_) row.fill(core);
        bool any = false;
        for (int k = z.first; k < z.second; ++k)
            for (int j = y.first; j < y.second; ++j)
                any |= add_row(block, k * block.size[1] + j, below_[static_cast<std::size_t>(j - y.first)], number_of);
        if (!any) {
            bytes_.resize(begin);
            return;
        }
        VOXTONE_EXPECT(begin <= ~std::uint32_t{0});
        pieces_.push_back({static_cast<std::uint32_t>((at[2] * blocks_[1] + at[1]) * blocks_[0] + at[0]), slab_,
                           static_cast<std::uint32_t>(begin)});
    }

    bool add_row(const ShellBlock& block, int row, std::array<std::uint32_t, row_width>& below,
                 const NumberOf& number_of) {
        std::array<std::uint32_t, row_width> number;
        number.fill(core);
        unsigned skin = 0, as_below = 0, as_left = 0;
        literal_.clear();
        std::uint32_t left = core;
        for (unsigned bits = block.shell[row]; bits != 0; bits &= bits - 1) {
            const int lane = __builtin_ctz(bits);
            const std::uint32_t found = number_of(block, row * row_width + lane);
            if (found == core) continue;
            number[static_cast<std::size_t>(lane)] = found;
            const unsigned bit = 1u << lane;
            skin |= bit;
            if (below[static_cast<std::size_t>(lane)] == found)
                as_below |= bit;
            else if (left == found)
                as_left |= bit;
            else
                literal_.push_back(found);
            left = found;
        }
        below = number;
        bytes_.push_back(static_cast<std::uint8_t>(skin));
        if (skin == 0) return false;
        bytes_.push_back(static_cast<std::uint8_t>(as_below));
        bytes_.push_back(static_cast<std::uint8_t>(as_left));
        for (const std::uint32_t n : literal_) append_number(bytes_, n);
        return true;
    }

    const std::array<int, 3>& blocks_;
    std::uint16_t slab_;
    std::vector<std::uint8_t>& bytes_;
    std::vector<Piece>& pieces_;
    std::array<std::array<std::uint32_t, row_width>, volume_edge> below_;
    std::vector<std::uint32_t> literal_;
};

SkinVoxels::SkinVoxels(const VoxelGrid& grid) {
    for (std::size_t a = 0; a < 3; ++a) blocks_[a] = (grid.size[a] + volume_edge - 1) / volume_edge;
}

std::optional<SkinVoxels> SkinVoxels::of(const VoxelGrid& grid, int block_layers, const VisitSlab& visit_slab,
                                         const NumberOf& number_of, std::uint64_t most_bytes) {
    SkinVoxels skin(grid);
    skin.bytes_.resize(static_cast<std::size_t>((grid.size[2] + block_layers - 1) / block_layers));
    std::vector<std::vector<Piece>> pieces(skin.bytes_.size());
    std::atomic<std::uint64_t> bytes = 0;
    parallel_for(0, skin.bytes_.size(), 1, [&](std::size_t slab) {
        if (bytes.load(std::memory_order_relaxed) > most_bytes) return;
        std::vector<std::uint8_t> written;
        Writer writer(skin.blocks_, static_cast<std::uint16_t>(slab), written, pieces[slab]);
        visit_slab(static_cast<int>(slab), [&](const ShellBlock& block) { writer.add(block, number_of); });
        skin.bytes_[slab].assign(written.begin(), written.end());
        bytes.fetch_add(written.size() + pieces[slab].size() * sizeof(Piece), std::memory_order_relaxed);
    });
    if (bytes > most_bytes) return std::nullopt;
    std::size_t count = 0;
    for (const auto& of_slab : pieces) count += of_slab.size();
    skin.pieces_.reserve(count);
    for (const auto& of_slab : pieces) skin.pieces_.insert(skin.pieces_.end(), of_slab.begin(), of_slab.end());
    std::ranges::sort(skin.pieces_, {}, [](const Piece& p) { return std::tuple(p.block, p.slab, p.begin); });
    const std::size_t blocks = static_cast<std::size_t>(skin.blocks_[0]) * static_cast<std::size_t>(skin.blocks_[1]) *
                               static_cast<std::size_t>(skin.blocks_[2]);
    skin.first_piece_.assign(blocks + 1, 0);
    for (const Piece& piece : skin.pieces_) ++skin.first_piece_[piece.block + 1];
    for (std::size_t b = 0; b < blocks; ++b) skin.first_piece_[b + 1] += skin.first_piece_[b];
    return skin;
}

void SkinVoxels::read(std::size_t block, std::vector<Voxel>& out) const {
    std::array<std::array<std::uint32_t, row_width>, volume_edge> below{};
    for (std::uint32_t p = first_piece_[block]; p < first_piece_[block + 1]; ++p) {
        const std::uint8_t* at = bytes_[pieces_[p].slab].data() + pieces_[p].begin;
        const PieceHead head{at[0], at[1], at[2], at[3], at[4]};
        at += sizeof head;
        for (unsigned k = 0; k < head.layers; ++k)
            for (unsigned j = 0; j < head.rows; ++j) {
                const unsigned skin = *at++;
                if (skin == 0) continue;
                const unsigned as_below = *at++, as_left = *at++;
                std::uint32_t left = core;
                for (unsigned bits = skin; bits != 0; bits &= bits - 1) {
                    const auto lane = static_cast<unsigned>(__builtin_ctz(bits));
                    std::uint32_t& number = below[j][lane];
                    if (as_left >> lane & 1) {
                        number = left;
                    } else if (!(as_below >> lane & 1)) {
                        std::memcpy(&number, at, sizeof number);
                        at += sizeof number;
                    }
                    left = number;
                    out.push_back(
                        {static_cast<std::uint16_t>(((head.z + k) * 16 + head.y + j) * 16 + head.x + lane), left});
                }
            }
    }
}

/// Screens the voxels of a block.
class SkinVoxels::Remake final : public optics::BlockRemake {
public:
    Remake(const SkinVoxels& skin, std::span<const halftone::CumulativeMixture> mixture, int resins,
           const halftone::BlueNoiseScreen& screen, const halftone::Translucency* thinned)
        : skin_(skin), mixture_(mixture), resins_(resins), screen_(screen), thinned_(thinned) {}

    [[nodiscard]] bool touches(const std::array<int, 3>& block) const override {
        const std::size_t b = number_of(block);
        return skin_.first_piece_[b] != skin_.first_piece_[b + 1];
    }
    void remake(const std::array<int, 3>& block, std::span<optics::Material> voxels) const override {
        thread_local std::vector<Voxel> skin;
        skin.clear();
        skin_.read(number_of(block), skin);
        const int i0 = block[0] * volume_edge, j0 = block[1] * volume_edge, k0 = block[2] * volume_edge;
        for (const auto& [place, number] : skin) {
            const std::uint16_t threshold = screen_.threshold(i0 + place % 16, j0 + place / 16 % 16, k0 + place / 256);
            voxels[place] =
                static_cast<optics::Material>(1 + (thinned_ ? thin(number, threshold) : select(number, threshold)));
        }
    }

private:
    [[nodiscard]] int select(std::uint32_t number, std::uint16_t threshold) const {
        return halftone::select_resin(number == clear ? mixture_.back() : mixture_[number], threshold, resins_);
    }
    [[nodiscard]] int thin(std::uint32_t number, std::uint16_t threshold) const {
        constexpr std::uint32_t steps = halftone::Translucency::kept_steps;
        const float kept = halftone::Translucency::kept_of(number % steps);
        return halftone::select_resin(thinned_->diluted(mixture_[number / steps], kept), threshold, resins_);
    }
    [[nodiscard]] std::size_t number_of(const std::array<int, 3>& block) const {
        return (static_cast<std::size_t>(block[2]) * static_cast<std::size_t>(skin_.blocks_[1]) +
                static_cast<std::size_t>(block[1])) *
                   static_cast<std::size_t>(skin_.blocks_[0]) +
               static_cast<std::size_t>(block[0]);
    }
    const SkinVoxels& skin_;
    std::span<const halftone::CumulativeMixture> mixture_;
    int resins_;
    const halftone::BlueNoiseScreen& screen_;
    const halftone::Translucency* thinned_;
};

optics::ResinVolume SkinVoxels::print(const optics::ResinVolume& shape, optics::Material core_material,
                                      std::span<const halftone::CumulativeMixture> mixture, int resins,
                                      const halftone::BlueNoiseScreen& screen, const Progress& progress,
                                      const halftone::Translucency* thinned) const {
    const Remake remake(*this, mixture, resins, screen, thinned);
    return optics::remade(shape, core_material, &remake, &progress);
}

void SkinVoxels::for_each(const optics::VoxelBox& box,
                          const std::function<void(const std::array<int, 3>&, std::uint32_t)>& visit,
                          const Progress& progress) const {
    std::array<int, 3> first{}, end{};
    for (std::size_t a = 0; a < 3; ++a) {
        first[a] = std::max(box.begin[a], 0) / volume_edge;
        end[a] = std::clamp((box.end[a] + volume_edge - 1) / volume_edge, first[a], std::max(first[a], blocks_[a]));
    }
    const auto row = static_cast<std::size_t>(end[0] - first[0]),
               plane = row * static_cast<std::size_t>(end[1] - first[1]);
    parallel_for(
        0, plane * static_cast<std::size_t>(end[2] - first[2]), 16,
        [&](std::size_t i) {
            const int bx = first[0] + static_cast<int>(i % row), by = first[1] + static_cast<int>(i % plane / row),
                      bz = first[2] + static_cast<int>(i / plane);
            std::vector<Voxel> skin;
            read(static_cast<std::size_t>((bz * blocks_[1] + by) * blocks_[0] + bx), skin);
            for (const auto& [place, number] : skin) {
                const std::array<int, 3> voxel{bx * volume_edge + place % 16, by * volume_edge + place / 16 % 16,
                                               bz * volume_edge + place / 256};
                if (box.holds(voxel)) visit(voxel, number);
            }
        },
        &progress);
}

std::size_t SkinVoxels::memory_bytes() const {
    std::size_t bytes = pieces_.capacity() * sizeof(Piece) + first_piece_.capacity() * sizeof first_piece_[0];
    for (const auto& of_slab : bytes_) bytes += of_slab.capacity();
    return bytes;
}

}  // namespace voxtone::slicer

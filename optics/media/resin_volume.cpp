// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/media/resin_volume.h"

#include <algorithm>
#include <utility>

#include "base/contracts.h"
#include "base/parallel.h"

namespace voxtone::optics {
namespace {

constexpr int edge = ResinVolume::block_edge;
constexpr std::size_t block_voxels = std::size_t{edge} * edge * edge;
using Block = std::array<Material, block_voxels>;

/// What begins a packed block: its bits a voxel, and what their values stand for; of 8 bits, materials themselves.
constexpr std::size_t head_bytes = 64;
constexpr std::size_t most_in_palette = 16;

/// Reads a packed block.
class PackedBlock {
public:
    explicit PackedBlock(const std::uint8_t* head) : palette_(head + 1), voxels_(head + head_bytes), bits_(head[0]) {}
    [[nodiscard]] Material operator[](std::size_t voxel) const {
        Material material = air;
        copy(voxel, 1, &material);
        return material;
    }
    void copy(std::size_t first, std::size_t count, Material* to) const {
        switch (bits_) {
            case 1:
                return unpack<1>(first, count, to);
            case 2:
                return unpack<2>(first, count, to);
            case 4:
                return unpack<4>(first, count, to);
            default:
                std::copy_n(voxels_ + first, count, to);
        }
    }

private:
    template <unsigned bits>
    void unpack(std::size_t first, std::size_t count, Material* to) const {
        constexpr std::size_t per_byte = 8 / bits;
        for (std::size_t i = first; i < first + count; ++i)
            *to++ = palette_[voxels_[i / per_byte] >> (i % per_byte * bits) & ((1u << bits) - 1)];
    }

    const std::uint8_t *palette_, *voxels_;
    unsigned bits_;
};

unsigned bits_for(std::size_t materials) {
    if (materials > most_in_palette) return 8;
    return materials > 4 ? 4 : materials > 2 ? 2 : 1;
}

template <unsigned bits>
void pack(const Block& block, const std::array<std::uint8_t, 256>& value, std::uint8_t* to) {
    constexpr std::size_t per_byte = 8 / bits;
    for (std::size_t i = 0; i < block_voxels; i += per_byte) {
        unsigned byte = 0;
        for (std::size_t n = 0; n < per_byte; ++n) byte |= static_cast<unsigned>(value[block[i + n]]) << (n * bits);
        *to++ = static_cast<std::uint8_t>(byte);
    }
}

/// Appends a block; where it begins, in units.
std::int32_t append_packed(const Block& block, std::vector<std::uint8_t>& packed) {
    std::array<std::uint8_t, 256> value{};
    std::array<bool, 256> known{};
    std::array<Material, 256> palette{};
    std::size_t materials = 0;
    for (const Material m : block)
        if (!known[m]) {
            known[m] = true;
            value[m] = static_cast<std::uint8_t>(materials);
            palette[materials++] = m;
        }
    const unsigned bits = bits_for(materials);
    const std::size_t begin = packed.size(), per_byte = 8 / bits;
    packed.resize(begin + head_bytes + block_voxels / per_byte);
    std::uint8_t* const head = packed.data() + begin;
    head[0] = static_cast<std::uint8_t>(bits);
    if (bits == 8) {
        std::copy(block.begin(), block.end(), head + head_bytes);
        return static_cast<std::int32_t>(begin / head_bytes);
    }
    std::copy_n(palette.begin(), materials, head + 1);
    if (bits == 4)
        pack<4>(block, value, head + head_bytes);
    else if (bits == 2)
        pack<2>(block, value, head + head_bytes);
    else
        pack<1>(block, value, head + head_bytes);
    return static_cast<std::int32_t>(begin / head_bytes);
}

const std::uint8_t* head_of(const std::vector<std::uint8_t>& packed, std::int32_t block) {
    return packed.data() + static_cast<std::size_t>(block) * head_bytes;
}

std::size_t place_in_block(int x, int y, int z) {
    return static_cast<std::size_t>(((z % edge) * edge + y % edge) * edge + x % edge);
}

}  // namespace

std::size_t ResinVolume::block_index(int bx, int by, int bz) const {
    return (static_cast<std::size_t>(bz) * static_cast<std::size_t>(blocks_[1]) + static_cast<std::size_t>(by)) *
               static_cast<std::size_t>(blocks_[0]) +
           static_cast<std::size_t>(bx);
}

Material ResinVolume::at(int x, int y, int z) const {
    if (x < 0 || y < 0 || z < 0 || x >= size_[0] || y >= size_[1] || z >= size_[2]) return air;
    const std::int32_t block = block_[block_index(x / edge, y / edge, z / edge)];
    if (block < 0) return static_cast<Material>(-1 - block);
    return PackedBlock(head_of(packed_, block))[place_in_block(x, y, z)];
}

void ResinVolume::copy_box(const std::array<int, 3>& corner, const std::array<int, 3>& extent,
                           std::span<Material> out) const {
    const auto row = static_cast<std::size_t>(extent[0]);
    VOXTONE_EXPECT(out.size() == row * static_cast<std::size_t>(extent[1]) * static_cast<std::size_t>(extent[2]));
    std::fill(out.begin(), out.end(), air);
    const int x0 = std::max(corner[0], 0), x1 = std::min(corner[0] + extent[0], size_[0]);
    for (int z = std::max(corner[2], 0); z < std::min(corner[2] + extent[2], size_[2]); ++z)
        for (int y = std::max(corner[1], 0); y < std::min(corner[1] + extent[1], size_[1]); ++y) {
            Material* const line =
                out.data() + (static_cast<std::size_t>(z - corner[2]) * static_cast<std::size_t>(extent[1]) +
                              static_cast<std::size_t>(y - corner[1])) *
                                 row;
            for (int x = x0; x < x1;) {
                const int end = std::min(x1, (x / edge + 1) * edge);
                const std::int32_t block = block_[block_index(x / edge, y / edge, z / edge)];
                Material* const to = line + (x - corner[0]);
                if (block < 0) {
                    std::fill(to, to + (end - x), static_cast<Material>(-1 - block));
                } else {
                    PackedBlock(head_of(packed_, block))
                        .copy(place_in_block(x, y, z), static_cast<std::size_t>(end - x), to);
                }
                x = end;
            }
        }
}

int ResinVolume::uniform_material(const std::array<int, 3>& corner, const std::array<int, 3>& extent) const {
    const Material first = at(corner[0], corner[1], corner[2]);
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        if (first != air && (corner[a] < 0 || corner[a] + extent[a] > size_[a])) return -1;
    }
    std::array<int, 3> low{}, high{};
    for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::max(corner[a], 0);
        high[a] = std::min(corner[a] + extent[a], size_[a]);
        if (low[a] >= high[a]) return air;
    }
    for (int bz = low[2] / edge; bz <= (high[2] - 1) / edge; ++bz)
        for (int by = low[1] / edge; by <= (high[1] - 1) / edge; ++by)
            for (int bx = low[0] / edge; bx <= (high[0] - 1) / edge; ++bx) {
                const std::int32_t block = block_[block_index(bx, by, bz)];
                if (block < 0) {
                    if (-1 - block != first) return -1;
                    continue;
                }
                const PackedBlock voxels(head_of(packed_, block));
                for (int z = std::max(low[2], bz * edge); z < std::min(high[2], (bz + 1) * edge); ++z)
                    for (int y = std::max(low[1], by * edge); y < std::min(high[1], (by + 1) * edge); ++y)
                        for (int x = std::max(low[0], bx * edge); x < std::min(high[0], (bx + 1) * edge); ++x)
                            if (voxels[place_in_block(x, y, z)] != first) return -1;
            }
    return first;
}

std::array<std::uint64_t, 256> ResinVolume::count() const {
    std::vector<std::array<std::uint64_t, 256>> of_slab(static_cast<std::size_t>(blocks_[2]));
    parallel_for(0, of_slab.size(), 1, [&](std::size_t slab) {
        auto& counts = of_slab[slab] = {};
        const int bz = static_cast<int>(slab);
        for (int by = 0; by < blocks_[1]; ++by)
            for (int bx = 0; bx < blocks_[0]; ++bx) {
                const std::int32_t block = block_[block_index(bx, by, bz)];
                const int nx = std::min(edge, size_[0] - bx * edge), ny = std::min(edge, size_[1] - by * edge),
                          nz = std::min(edge, size_[2] - bz * edge);
                if (block < 0) {
                    counts[static_cast<std::size_t>(-1 - block)] += static_cast<std::uint64_t>(nx) *
                                                                    static_cast<std::uint64_t>(ny) *
                                                                    static_cast<std::uint64_t>(nz);
                    continue;
                }
                const PackedBlock voxels(head_of(packed_, block));
                for (int z = 0; z < nz; ++z)
                    for (int y = 0; y < ny; ++y)
                        for (int x = 0; x < nx; ++x) ++counts[voxels[place_in_block(x, y, z)]];
            }
    });
    std::array<std::uint64_t, 256> counts{};
    for (const auto& slab : of_slab)
        for (std::size_t m = 0; m < counts.size(); ++m) counts[m] += slab[m];
    return counts;
}

std::size_t ResinVolume::memory_bytes() const { return block_.size() * sizeof(block_[0]) + packed_.size(); }

ResinVolumeBuilder::ResinVolumeBuilder(const std::array<int, 3>& size, const std::array<double, 3>& pitch_mm) {
    for (std::size_t a = 0; a < 3; ++a) {
        VOXTONE_EXPECT(size[a] >= 1 && pitch_mm[a] > 0);
        volume_.blocks_[a] = (size[a] + edge - 1) / edge;
    }
    volume_.size_ = size;
    volume_.pitch_mm_ = pitch_mm;
}

void ResinVolumeBuilder::add_layer(std::span<const Material> layer) {
    const auto& size = volume_.size_;
    const auto row = static_cast<std::size_t>(size[0]), plane = row * static_cast<std::size_t>(size[1]);
    VOXTONE_EXPECT(layer.size() == plane && layers_ < size[2]);
    slab_.resize(plane * edge);
    std::copy(layer.begin(), layer.end(), slab_.begin() + static_cast<std::ptrdiff_t>(plane) * (layers_ % edge));
    ++layers_;
    if (layers_ % edge != 0 && layers_ != size[2]) return;
    for (int by = 0; by < volume_.blocks_[1]; ++by)
        append_blocks(slab_.data() + static_cast<std::size_t>(by * edge) * row, row, plane,
                      std::min(edge, size[1] - by * edge), (layers_ - 1) % edge + 1);
}

void ResinVolumeBuilder::add_block_row(std::span<const Material> voxels) {
    const auto& size = volume_.size_;
    const int by = block_rows_ % volume_.blocks_[1], bz = block_rows_ / volume_.blocks_[1];
    VOXTONE_EXPECT(slab_.empty() && bz < volume_.blocks_[2]);
    const int rows = std::min(edge, size[1] - by * edge), layers = std::min(edge, size[2] - bz * edge);
    const auto row = static_cast<std::size_t>(size[0]), plane = row * static_cast<std::size_t>(rows);
    VOXTONE_EXPECT(voxels.size() == plane * static_cast<std::size_t>(layers));
    append_blocks(voxels.data(), row, plane, rows, layers);
    if (++block_rows_ % volume_.blocks_[1] == 0) layers_ += layers;
}

void ResinVolumeBuilder::append_blocks(const Material* first, std::size_t row_stride, std::size_t plane_stride,
                                       int rows, int layers) {
    Block block;
    for (int bx = 0; bx < volume_.blocks_[0]; ++bx) {
        const Material* const corner = first + static_cast<std::size_t>(bx * edge);
        const int nx = std::min(edge, volume_.size_[0] - bx * edge);
        block.fill(air);
        bool uniform = true;
        for (int z = 0; z < layers; ++z)
            for (int y = 0; y < rows; ++y) {
                const Material* const from =
                    corner + static_cast<std::size_t>(z) * plane_stride + static_cast<std::size_t>(y) * row_stride;
                Material* const to = block.data() + (z * edge + y) * edge;
                for (int x = 0; x < nx; ++x) {
                    to[x] = from[x];
                    uniform &= from[x] == *corner;
                }
            }
        if (uniform) {
            volume_.block_.push_back(-1 - *corner);
            continue;
        }
        volume_.block_.push_back(append_packed(block, volume_.packed_));
    }
}

ResinVolume ResinVolumeBuilder::finish() {
    VOXTONE_EXPECT(layers_ == volume_.size_[2]);
    return std::move(volume_);
}

ResinVolume stacked(std::vector<ResinVolume> parts) {
    VOXTONE_EXPECT(!parts.empty());
    ResinVolume whole;
    whole.size_ = parts.front().size_;
    whole.blocks_ = parts.front().blocks_;
    whole.pitch_mm_ = parts.front().pitch_mm_;
    whole.size_[2] = whole.blocks_[2] = 0;
    std::size_t blocks = 0, packed = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const ResinVolume& part = parts[i];
        VOXTONE_EXPECT(part.size_[0] == whole.size_[0] && part.size_[1] == whole.size_[1] &&
                       part.pitch_mm_ == whole.pitch_mm_ && (i + 1 == parts.size() || part.size_[2] % edge == 0));
        whole.size_[2] += part.size_[2];
        whole.blocks_[2] += part.blocks_[2];
        blocks += part.block_.size();
        packed += part.packed_.size();
    }
    // Room for all at once: memory that is only reserved costs nothing until it is written, part by part.
    whole.block_.reserve(blocks);
    whole.packed_.reserve(packed);
    for (ResinVolume& part : parts) {
        const auto offset = static_cast<std::int32_t>(whole.packed_.size() / head_bytes);
        for (const std::int32_t block : part.block_) whole.block_.push_back(block < 0 ? block : block + offset);
        whole.packed_.insert(whole.packed_.end(), part.packed_.begin(), part.packed_.end());
        part = ResinVolume();
    }
    return whole;
}

ResinVolume all_of(const ResinVolume& volume, Material material) { return remade(volume, material, nullptr); }

namespace {

/// A block while it is made: its voxels inside the volume are a box at its corner.
struct OpenBlock {
    Block voxels;
    std::array<int, 3> inside{};

    template <class Visit>
    void for_each_row(Visit&& visit) {
        for (int z = 0; z < inside[2]; ++z)
            for (int y = 0; y < inside[1]; ++y)
                visit(std::span(voxels).subspan(place_in_block(0, y, z), static_cast<std::size_t>(inside[0])));
    }
    void fill(Material material) {
        voxels.fill(air);
        for_each_row([&](std::span<Material> row) { std::ranges::fill(row, material); });
    }
    void replace_solid(Material material) {
        for (Material& voxel : voxels) voxel = voxel == air ? air : material;
    }
    [[nodiscard]] bool is_uniform() {
        bool uniform = true;
        for_each_row([&](std::span<const Material> row) {
            for (const Material voxel : row) uniform &= voxel == voxels[0];
        });
        return uniform;
    }
};

}  // namespace

ResinVolume remade(const ResinVolume& volume, Material material, const BlockRemake* remake, const Progress* progress) {
    std::vector<ResinVolume> slabs(static_cast<std::size_t>(volume.blocks_[2]));
    parallel_for(
        0, slabs.size(), 1,
        [&](std::size_t slab) {
            const int bz = static_cast<int>(slab);
            ResinVolume& made = slabs[slab];
            made.size_ = volume.size_, made.blocks_ = volume.blocks_, made.pitch_mm_ = volume.pitch_mm_;
            made.size_[2] = std::min(edge, volume.size_[2] - bz * edge), made.blocks_[2] = 1;
            made.block_.reserve(volume.block_.size() / slabs.size());
            OpenBlock open;
            for (int by = 0; by < volume.blocks_[1]; ++by)
                for (int bx = 0; bx < volume.blocks_[0]; ++bx) {
                    const std::array<int, 3> at{bx, by, bz};
                    const std::int32_t block = volume.block_[volume.block_index(bx, by, bz)];
                    const bool touched = remake && remake->touches(at);
                    if (block < 0 && !touched) {
                        made.block_.push_back(block == -1 - air ? block : -1 - material);
                        continue;
                    }
                    for (std::size_t a = 0; a < 3; ++a) open.inside[a] = std::min(edge, volume.size_[a] - at[a] * edge);
                    if (block < 0) {
                        open.fill(block == -1 - air ? air : material);
                    } else {
                        PackedBlock(head_of(volume.packed_, block)).copy(0, block_voxels, open.voxels.data());
                        open.replace_solid(material);
                    }
                    if (touched) remake->remake(at, open.voxels);
                    made.block_.push_back(open.is_uniform() ? -1 - open.voxels[0]
                                                            : append_packed(open.voxels, made.packed_));
                }
        },
        progress);
    return stacked(std::move(slabs));
}

}  // namespace voxtone::optics

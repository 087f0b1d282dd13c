// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which resin fills each voxel of a print: the input of every appearance model.
//
// Voxel (x, y, z) covers [x, x + 1) pitch_x x [y, y + 1) pitch_y x [z, z + 1) pitch_z, in mm from the volume's corner;
// x runs right, y away, z up, layer 0 is the bottom. Material 0 is air, material m is resin m - 1 of the set in use.
//
// Storage: blocks of 16^3 voxels; a block of one material costs 4 bytes, others 64 bytes and 1, 2, 4 or 8 bits a voxel
// where they hold up to 2, 4, 16 or more materials. Immutable after construction.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/progress.h"

namespace voxtone::optics {

using Material = std::uint8_t;
inline constexpr Material air = 0;

/// Blocks of a volume to be made anew.
class BlockRemake {
public:
    virtual ~BlockRemake() = default;
    /// From any thread.
    [[nodiscard]] virtual bool touches(const std::array<int, 3>& block) const = 0;
    /// `voxels`: of the block, x fastest, then y, then z; what sticks out of the volume has to stay air. From any
    /// thread.
    virtual void remake(const std::array<int, 3>& block, std::span<Material> voxels) const = 0;
};

class ResinVolume {
public:
    static constexpr int block_edge = 16;

    ResinVolume() = default;

    [[nodiscard]] const std::array<int, 3>& size() const { return size_; }
    [[nodiscard]] const std::array<double, 3>& pitch_mm() const { return pitch_mm_; }
    /// Air outside the volume.
    [[nodiscard]] Material at(int x, int y, int z) const;
    /// The box of `extent` voxels from `corner` (may stick out: air there), x fastest, then y, then z.
    void copy_box(const std::array<int, 3>& corner, const std::array<int, 3>& extent, std::span<Material> out) const;
    /// The material that fills the whole box, or -1 where there are several (never wrong for boxes inside one block).
    [[nodiscard]] int uniform_material(const std::array<int, 3>& corner, const std::array<int, 3>& extent) const;
    /// How many voxels each material has; index = material.
    [[nodiscard]] std::array<std::uint64_t, 256> count() const;
    [[nodiscard]] std::size_t memory_bytes() const;

private:
    friend class ResinVolumeBuilder;
    friend ResinVolume stacked(std::vector<ResinVolume> parts);
    friend ResinVolume remade(const ResinVolume& volume, Material material, const BlockRemake* remake,
                              const Progress* progress);
    [[nodiscard]] std::size_t block_index(int bx, int by, int bz) const;

    std::array<int, 3> size_{}, blocks_{};
    std::array<double, 3> pitch_mm_{};
    std::vector<std::int32_t> block_;  ///< >= 0: where it begins in packed_, in units of 64 bytes; < 0: -1 - material
    std::vector<std::uint8_t> packed_;
};

/// Builds a volume from the bottom, layer by layer (holds 16 layers besides the blocks that are done) or row of blocks
/// by row of blocks (holds nothing besides); one way or the other for a volume.
class ResinVolumeBuilder {
public:
    /// size >= 1 voxel, pitch > 0 mm along each axis.
    ResinVolumeBuilder(const std::array<int, 3>& size, const std::array<double, 3>& pitch_mm);
    /// size x * size y materials, x fastest, y ascending.
    void add_layer(std::span<const Material> layer);
    /// The next row of blocks, y ascending, then z: `voxels` of the whole width, of 16 rows and 16 layers (of what is
    /// left of them at the border), x fastest, then y, then z.
    void add_block_row(std::span<const Material> voxels);
    /// After the last layer.
    [[nodiscard]] ResinVolume finish();

private:
    void append_blocks(const Material* first, std::size_t row_stride, std::size_t plane_stride, int rows, int layers);
    ResinVolume volume_;
    std::vector<Material> slab_;
    int layers_ = 0, block_rows_ = 0;
};

/// Volumes of the same width, depth and pitch one above the other, the first one lowest; all but the last have a
/// multiple of 16 layers. The parts are freed one by one, so that the whole is held once.
[[nodiscard]] ResinVolume stacked(std::vector<ResinVolume> parts);

/// The same volume with every solid voxel of one resin: the "paper white" that media-relative colour refers to. Needs
/// less memory than the volume: only blocks that the surface passes have several materials.
[[nodiscard]] ResinVolume all_of(const ResinVolume& volume, Material material);

/// The same, of which some blocks are made anew then; null: none.
[[nodiscard]] ResinVolume remade(const ResinVolume& volume, Material material, const BlockRemake* remake,
                                 const Progress* progress = nullptr);

/// A volume of one function of the voxel, for tests and benchmarks.
template <class MaterialOf>
[[nodiscard]] ResinVolume make_resin_volume(const std::array<int, 3>& size, const std::array<double, 3>& pitch_mm,
                                            MaterialOf&& material_of) {
    ResinVolumeBuilder builder(size, pitch_mm);
    std::vector<Material> layer(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]));
    for (int z = 0; z < size[2]; ++z) {
        std::size_t i = 0;
        for (int y = 0; y < size[1]; ++y)
            for (int x = 0; x < size[0]; ++x) layer[i++] = static_cast<Material>(material_of(x, y, z));
        builder.add_layer(layer);
    }
    return builder.finish();
}

}  // namespace voxtone::optics

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which mixture each voxel of the coloured skin is screened from, kept: prints that differ in their mixtures alone are
// made again without a search for the surface.
//
// A mixture has the number of its unknown in the loop, cell * layers + layer (SkinMap::at). Voxels below the skin are
// core and are not kept.
//
// Memory: about a byte a voxel (bundled cow). Voxels are kept by the blocks of a ResinVolume, row by row of up to eight
// along x: which of the row are of the skin, which have the number of the voxel below, which of the others that of
// their left neighbour, and the numbers of the rest.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/progress.h"
#include "halftone/loop/skin.h"
#include "halftone/screens/blue_noise_screen.h"
#include "halftone/separation/translucency.h"
#include "optics/media/resin_volume.h"
#include "optics/scene/surface.h"
#include "slicer/printer/voxel_grid.h"
#include "slicer/surface/surface_shell.h"

namespace voxtone::slicer {

class SkinVoxels {
public:
    /// Not of the skin.
    static constexpr std::uint32_t core = ~std::uint32_t{0};
    /// Of clear resin over or under the skin: by the last of the mixtures.
    static constexpr std::uint32_t clear = core - 1;
    /// The number of a shell voxel's mixture, `clear` or `core`.
    using NumberOf = std::function<std::uint32_t(const ShellBlock& block, int at)>;
    /// Hands over the blocks of one layer of shell blocks; called from several threads.
    using VisitSlab = std::function<void(int slab, const std::function<void(const ShellBlock&)>&)>;

    /// Nothing where they take more than `most_bytes`.
    [[nodiscard]] static std::optional<SkinVoxels> of(const VoxelGrid& grid, int block_layers,
                                                      const VisitSlab& visit_slab, const NumberOf& number_of,
                                                      std::uint64_t most_bytes);

    /// `shape`: of the body; what is not of the skin becomes `core_material`. `mixture`: by number, of so many resins.
    /// `thinned`: a number is that of a mixture times Translucency::kept_steps, and the step to which it is diluted.
    [[nodiscard]] optics::ResinVolume print(const optics::ResinVolume& shape, optics::Material core_material,
                                            std::span<const halftone::CumulativeMixture> mixture, int resins,
                                            const halftone::BlueNoiseScreen& screen, const Progress& progress,
                                            const halftone::Translucency* thinned = nullptr) const;

    /// Visits the voxels of a box with their numbers, from several threads at once.
    void for_each(const optics::VoxelBox& box,
                  const std::function<void(const std::array<int, 3>& voxel, std::uint32_t number)>& visit,
                  const Progress& progress) const;

    [[nodiscard]] std::size_t memory_bytes() const;

private:
    struct Voxel {
        std::uint16_t place;  ///< in its block: x + 16 y + 256 z
        std::uint32_t number;
    };
    /// Where the rows of a box of voxels begin.
    struct Piece {
        std::uint32_t block;
        std::uint16_t slab;  ///< whose bytes they are
        std::uint32_t begin;
    };
    class Writer;
    class Remake;

    explicit SkinVoxels(const VoxelGrid& grid);
    /// Appends what a block holds.
    void read(std::size_t block, std::vector<Voxel>& out) const;

    std::array<int, 3> blocks_{};
    std::vector<std::vector<std::uint8_t>> bytes_;  ///< per layer of shell blocks
    std::vector<Piece> pieces_;                     ///< by block
    std::vector<std::uint32_t> first_piece_;        ///< per block, and the end
};

}  // namespace voxtone::slicer

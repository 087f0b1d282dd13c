// SPDX-License-Identifier: GPL-3.0-or-later
//
// Layers as they are printed -> the volume that light is followed through. Layers may come in any order and from any
// thread, each once; sixteen of them make a slab of the volume as soon as the last of them is there.
//
// Rows of a bitmap run along -y, so row r of a layer of height h is y = h - 1 - r. Material m of a layer becomes
// `material_of[m]`. Of layers larger than the volume a window is taken.
//
// Memory: that of the volume, of the runs of unfinished slabs, and 256 bytes per voxel of the width for each thread.
#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "io/layers/layer_runs.h"
#include "optics/media/resin_volume.h"

namespace voxtone::slicer {

struct LayerWindow {
    std::array<int, 3> corner{};  ///< of the volume in the stack, voxels along x, y, z
    std::array<int, 3> size{};    ///< of the volume
};

/// Throws ResourceError where a volume of this size takes more bytes than it may.
void expect_volume_fits(const std::array<int, 3>& size, double bytes, std::uint64_t most_bytes);

class LayerVolume {
public:
    /// Throws ResourceError from `add` once the volume needs more than `memory_bytes`.
    LayerVolume(const LayerWindow& window, const std::array<double, 3>& pitch_mm,
                const std::array<optics::Material, io::max_materials>& material_of, std::uint64_t memory_bytes);

    /// Layer `k` of the stack. Layers outside the window are ignored.
    void add(int k, io::LayerRuns layer);
    /// After every layer of the window was added.
    [[nodiscard]] optics::ResinVolume finish();

    /// The materials as they are.
    [[nodiscard]] static std::array<optics::Material, io::max_materials> same_materials();

private:
    struct Slab {
        std::vector<std::optional<io::LayerRuns>> layers;
        int missing = 0;
        optics::ResinVolume volume;
    };
    [[nodiscard]] optics::ResinVolume build(const std::vector<std::optional<io::LayerRuns>>& layers) const;
    void count_memory(std::uint64_t bytes);

    LayerWindow window_;
    std::array<double, 3> pitch_mm_;
    std::array<optics::Material, io::max_materials> material_of_;
    std::uint64_t memory_bytes_, used_bytes_ = 0;
    std::size_t slabs_done_ = 0;
    std::mutex mutex_;
    std::vector<Slab> slabs_;
};

}  // namespace voxtone::slicer

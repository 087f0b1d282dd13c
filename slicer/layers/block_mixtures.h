// SPDX-License-Identifier: GPL-3.0-or-later
//
// The mixtures that the shell voxels of one block ask for: target colour at the nearest surface point, separated; or
// what the appearance loop found for them. And the screen that makes resins of them.
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "halftone/screens/blue_noise_screen.h"
#include "halftone/separation/separation.h"
#include "slicer/layers/block_fill.h"
#include "slicer/layers/layer_sources.h"
#include "slicer/layers/skin_source.h"
#include "slicer/surface/surface_colour.h"
#include "slicer/surface/surface_shell.h"
#include "slicer/surface/visible_surface.h"

namespace voxtone::slicer {

class BlockMixtures {
public:
    /// Of a shell by colour.
    explicit BlockMixtures(const LayerSources& sources);

    /// Looks up what the voxels of the block ask for; returns how many there are.
    std::size_t gather(const ShellBlock& block);
    /// Separates them; valid until the next call of `gather`.
    const halftone::CumulativeMixture* separate();

private:
    static constexpr std::size_t max_voxels = std::size_t(ShellBlock::max_rows) * ShellBlock::width;
    const VisibleSurface& surface_;
    const SurfaceColour& colour_;
    const halftone::Separation& separation_;
    const SkinSource* skin_;
    DepthZones zones_;
    TranslucentBody translucent_;
    const NightSide* night_;
    int core_;
    std::vector<halftone::CumulativeMixture> pure_;               ///< of each resin, where some voxels are of one
    std::vector<std::pair<std::size_t, int>> marked_;             ///< voxels of the block that are, and their resins
    std::vector<std::pair<std::size_t, float>> thinned_;          ///< those that are diluted, and to what
    std::vector<std::pair<std::size_t, Eigen::Vector3f>> dark_;   ///< those of the night, and what is asked of them
    std::vector<std::pair<std::size_t, Eigen::Vector3f>> apart_;  ///< those that the loop did not look at, and colours
    std::size_t count_ = 0;
    std::array<float, max_voxels> red_, green_, blue_;
    std::array<halftone::CumulativeMixture, max_voxels> mixture_;
};

/// One resin for every shell voxel, by the blue-noise screen.
class ScreenedMixtures : public BlockFill {
public:
    explicit ScreenedMixtures(const LayerSources& sources)
        : mixtures_(sources),
          screen_(*std::get<MixtureSources>(sources.resins).screen),
          resins_(static_cast<int>(std::get<MixtureSources>(sources.resins).separation.resins())) {}
    void fill(const ShellBlock& block, io::Material* out, LayerCounts& counts) override;

private:
    BlockMixtures mixtures_;
    const halftone::BlueNoiseScreen& screen_;
    int resins_;
};

/// A body as it is looked at, of one material: clear resin where it lies under the colours, nothing where it lies over
/// them.
class BareCore : public BlockFill {
public:
    BareCore(const DepthZones& zones, io::Material core) : zones_(zones), core_(core) {}
    void fill(const ShellBlock& block, io::Material* out, LayerCounts& counts) override;

private:
    DepthZones zones_;
    io::Material core_;
};

}  // namespace voxtone::slicer

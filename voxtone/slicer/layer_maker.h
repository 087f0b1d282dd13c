// SPDX-License-Identifier: GPL-3.0-or-later
//
// From the body to printed layers: solid -> surface shell -> target colour -> mixture -> one resin per voxel -> runs.
//
// Work is cut into slabs, the layers of one layer of shell blocks. A slab depends on nothing but its own index, so any
// number of threads and any choice of layers give the same bits. Within a slab rows of blocks are made one after the
// other in a strip that stays in cache; air and core are never touched voxel by voxel.
// Threads: `make` may be called from any thread, for different slabs at once.
#pragma once

#include <cstdint>
#include <functional>

#include "voxtone/halftone/blue_noise_screen.h"
#include "voxtone/halftone/separation.h"
#include "voxtone/io/layer_runs.h"
#include "voxtone/slicer/solid.h"
#include "voxtone/slicer/surface_colour.h"
#include "voxtone/slicer/surface_shell.h"
#include "voxtone/slicer/visible_surface.h"

namespace voxtone::slicer {

/// What layers are made of; everything must outlive the maker.
struct LayerSources {
    const Solid& solid;
    const VisibleSurface& surface;
    const SurfaceShell& shell;
    const SurfaceColour& colour;
    const halftone::Separation& separation;
    const halftone::BlueNoiseScreen& screen;
    io::Material core = 0;  ///< material of voxels below the shell
};

/// Counts of one or more slabs.
struct LayerCounts {
    std::uint64_t body_voxels = 0;
    std::uint64_t shell_voxels = 0;
    std::uint64_t thin_voxels = 0;  ///< added because the feature was thinner than a voxel
    /// Where the time went, seconds summed over threads.
    double solid_s = 0, shell_s = 0, colour_s = 0, screen_s = 0, runs_s = 0;
    LayerCounts& operator+=(const LayerCounts& other);
};

class LayerMaker {
public:
    explicit LayerMaker(const LayerSources& sources);

    [[nodiscard]] int slab_layers() const { return sources_.shell.block_size()[2]; }
    [[nodiscard]] int slabs() const { return sources_.shell.block_layers(); }

    /// Makes the layers of [k_begin, k_end) that lie in this slab, from the bottom up, and hands each to `sink`.
    LayerCounts make(int slab, int k_begin, int k_end, const std::function<void(int k, const io::LayerRuns& layer)>& sink) const;

private:
    LayerSources sources_;
    bool all_core_;  ///< one colour, and it is that of the core: no voxel needs a look
};

}  // namespace voxtone::slicer

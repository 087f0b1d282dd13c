// SPDX-License-Identifier: GPL-3.0-or-later
//
// From the body to printed layers: solid -> surface shell -> one resin per voxel -> runs. The resins of the shell are
// screened mixtures that make a target colour, or the layers of stacks wrapped around the body.
//
// Work is cut into slabs of layers. A slab depends on nothing but its own index, so any number of threads and any
// choice of layers give the same bits. With the blue-noise screen a slab is one layer of shell blocks, made row of
// blocks by row of blocks in a strip that stays in cache; air and core are never touched voxel by voxel. Error
// diffusion needs whole layers and has slabs of its own length. Threads: `make` may be called from any thread, for
// different slabs at once.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <variant>

#include "voxtone/halftone/screens/blue_noise_screen.h"
#include "voxtone/halftone/separation/separation.h"
#include "voxtone/io/layers/layer_runs.h"
#include "voxtone/slicer/layers/block_fill.h"
#include "voxtone/slicer/layers/skin_source.h"
#include "voxtone/slicer/layers/wrapped_layers.h"
#include "voxtone/slicer/solid/solid.h"
#include "voxtone/slicer/solid/thin_features.h"
#include "voxtone/slicer/surface/surface_colour.h"
#include "voxtone/slicer/surface/surface_shell.h"
#include "voxtone/slicer/surface/visible_surface.h"

namespace voxtone::slicer {

/// The shell by colour.
struct MixtureSources {
    const SurfaceColour& colour;
    const halftone::Separation& separation;
    const halftone::BlueNoiseScreen* screen;  ///< null: error diffusion
    std::uint64_t seed;                       ///< of error diffusion
    const SkinSource* skin = nullptr;         ///< the appearance loop's mixtures instead of the separation's
};

/// What layers are made of; everything must outlive the maker.
struct LayerSources {
    const Solid& solid;
    const ThinFeatures* thin;  ///< null: features thinner than a voxel may vanish
    const VisibleSurface& surface;
    const SurfaceShell& shell;
    io::Material core;                                          ///< material of voxels below the shell
    std::variant<MixtureSources, const WrappedLayers*> resins;  ///< of the shell
};

using LayerSink = std::function<void(int k, const io::LayerRuns& layer)>;

class LayerMaker {
public:
    explicit LayerMaker(const LayerSources& sources);

    [[nodiscard]] int slab_layers() const;

    /// Makes the layers of [k_begin, k_end) that lie in this slab, from the bottom up, and hands each to `sink`.
    LayerCounts make(int slab, int k_begin, int k_end, const LayerSink& sink) const;

private:
    LayerCounts make_screened(int slab, int first, int last, const LayerSink& sink) const;
    LayerCounts make_diffused(const MixtureSources& by_colour, int slab, int first, int last,
                              const LayerSink& sink) const;
    /// Null: by error diffusion.
    [[nodiscard]] std::unique_ptr<BlockFill> block_fill() const;
    [[nodiscard]] bool by_blocks() const;
    /// The voxels of [first, last); those from `counted_from` on are counted.
    void body(int first, int last, int counted_from, SpanSlab& out, LayerCounts& counts) const;

    LayerSources sources_;
    bool all_core_;  ///< one colour, and it is that of the core: no voxel needs a look
};

}  // namespace voxtone::slicer

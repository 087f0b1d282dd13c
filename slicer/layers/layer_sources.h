// SPDX-License-Identifier: GPL-3.0-or-later
//
// What layers are made of.
#pragma once

#include <cstdint>
#include <variant>

#include "halftone/screens/blue_noise_screen.h"
#include "halftone/separation/separation.h"
#include "halftone/separation/translucency.h"
#include "slicer/layers/block_fill.h"
#include "slicer/layers/depth_zones.h"
#include "slicer/layers/layer_source.h"
#include "slicer/layers/night_side.h"
#include "slicer/layers/skin_source.h"
#include "slicer/solid/solid.h"
#include "slicer/solid/span_slab.h"
#include "slicer/solid/thin_features.h"
#include "slicer/surface/surface_colour.h"
#include "slicer/surface/surface_shell.h"
#include "slicer/surface/visible_surface.h"

namespace voxtone::slicer {

/// A body whose resins are thinned by clear resin as alpha asks: a voxel at a depth is of what lies at k times that
/// depth in the body without (k: Translucency::kept), diluted to k. The surface shell reaches through the whole body.
struct TranslucentBody {
    const halftone::Translucency* kept = nullptr;  ///< null: there is none of this
    float shell_mm = 0;                            ///< without alpha
};

/// The shell by colour.
struct MixtureSources {
    const SurfaceColour& colour;
    const halftone::Separation& separation;
    const halftone::BlueNoiseScreen* screen;  ///< null: error diffusion
    std::uint64_t seed;                       ///< of error diffusion
    const SkinSource* skin = nullptr;         ///< the appearance loop's mixtures instead of the separation's
    TranslucentBody translucent = {};
    const NightSide* night = nullptr;  ///< of a slab that has one
};

/// Everything must outlive the maker of layers.
struct LayerSources {
    const Solid& solid;
    const ThinFeatures* thin;  ///< null: features thinner than a voxel may vanish
    const VisibleSurface& surface;
    const SurfaceShell& shell;
    io::Material core;                                      ///< material of voxels below the shell
    std::variant<MixtureSources, const ShellFill*> resins;  ///< of the shell
    bool core_only = false;  ///< no shell: the body's shape, bare of what is clear over it
    DepthZones zones = {};   ///< of a shell by colour
};

/// The body's voxels in the layers [first, last), thin features included; those from `counted_from` on are counted.
void body_voxels(const LayerSources& sources, int first, int last, int counted_from, SpanSlab& out,
                 LayerCounts& counts);

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Light that leaves one part of a body and meets another, for models that take each place as if it saw the sky alone.
//
// With a the appearance of a cell under the whole sky (flux out / flux that entered), r the share of diffuse light that
// the surface mirrors from outside, and S the cosine-weighed share of directions of cell i that end on cell j, the
// light that falls on i, in units of the sky's, is
//
//   I_i = 1 - sum_j S_ij + sum_j S_ij (r + (1 - r) a_j) I_j,      and the cell is seen as a_i I_i
//
// (the radiosity of diffuse patches: C. M. Goral, K. E. Torrance, D. P. Greenberg, B. Battaile, "Modeling the
// interaction of light between diffuse surfaces", SIGGRAPH 1984). A body that absorbs nothing keeps a = 1, as it must.
// All bounces count: once S is known they cost nothing. By reciprocity a_i I_i is the share of the light that enters
// through i which reaches the sky, however often it meets the body again: what MonteCarloOptions::follow_outside
// counts.
//
// S is found by `directions` rays a cell through the mesh of the cells (cell_mesh.h), one set turned for each cell: S
// of one cell has a standard error of about 0.03. Rays begin half a cell above the surface, so that the steps of cells
// do not shade each other, and the mesh of cells cuts edges by half a cell: what is narrower than some cells is seen
// too bright.
//
// Against Monte Carlo (boundary_benchmark 60 outside): folds of a cow of 12 mm within 0.2 to 1.3 CIEDE2000, 2 to 5
// without it. What it cannot see: that light which falls on a cell leaves it elsewhere. Translucent walls that the sky
// lights from their other side come out too dark (the inside of a cup with walls of 0.8 mm: 12 CIEDE2000, 10 without
// it), and shades are sharper than light below the surface makes them. Nor the mirror's direction, and that a flat
// surface sends more light straight up than a diffuse one.
//
// Memory: 4 bytes for each ray that ends on the body. Same bits for any number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/progress.h"
#include "optics/scene/appearance_model.h"

namespace voxtone::slicer {

class PartsInSight {
public:
    static constexpr std::size_t directions = 64;

    /// `surface`: SurfacePart::all of the volume. Throws ResourceError where Embree cannot start, Cancelled.
    PartsInSight(const optics::ResinVolume& volume, const optics::Surface& surface, const Progress* progress = nullptr);

    /// Share of the sky that each cell sees.
    [[nodiscard]] std::vector<float> open_sky() const;
    /// a becomes a I, in place: value[cell * channels + channel]. `eta`: of the resins.
    void shade(std::span<float> value, std::size_t channels, double eta) const;
    [[nodiscard]] std::size_t memory_bytes() const;

private:
    std::vector<std::size_t> first_;  ///< per cell, and one past the last
    std::vector<std::uint32_t> met_;  ///< cells
};

/// A model whose answers are shaded so. Keeps a reference to `parts`; its surface is the one asked about.
[[nodiscard]] std::unique_ptr<const optics::AppearanceModel> with_light_between_parts(
    std::unique_ptr<const optics::AppearanceModel> model, const PartsInSight& parts);

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The layered profiles of Hasan et al. 2010 as an appearance model: the layers under each surface cell, stacked, and
// the light that goes sideways between cells.
//
// What a walk inwards from a cell meets is a mixture for every depth (column_sampling.h). A mixture has one K and one S
// per channel: those of its resins (Kubelka and Munk's, known at `known_mm`: layer_profile.h) by volume. Its total
// reflectance is that of its laminate, k = 0. The layer next to a surface, `bounded_mm` of it at most, is solved
// together with the surface in all directions (bounded_totals), because light that a surface lets in is not diffuse.
// The walk ends on the other side of thin parts: a surface again, where light leaves, and where the same light enters
// if it lies open; a sheet under the faces on the plane z = 0 sends back nothing or everything.
//
// Sideways: to a wave exp(i kappa x) of light what runs sideways is lost as if it were absorbed, so a mixture is a
// layer with
//
//   K(kappa) = K + 2 (sqrt(sigma^2 + kappa^2) - sigma) 2 / 3,   S(kappa) = S,   sigma = (K + 2 S) 2 / 3
//
// which is diffusion for long waves and free flight for short ones. The same laminate without its surface gives the
// shape of the local profile, its total the height; profiles are exchanged between cells by Eq. 7, with the bounces
// under the surface (lateral_transport.h).
//
// Error: docs/laminate-search.md. A surface that is the same everywhere shows the total of its laminate.
//
// What it cannot see: what lies on the way of light between two cells, but where it meets the surface (patches of half
// a millimetre on white come out too bright, by a quarter); light that enters at the side of a box and leaves at its
// top, or is lost there; light that crosses a wall goes straight across. Edges of bodies that absorb nothing come out
// too dark, by 14 % at most seen. Neither does it see that voxels of a halftone are pure: they are mixed. For that
// there are the transport predictor and Monte Carlo. Cells that are not in the surface that it is asked about give no
// light.
//
// Time on one core of 2.5 GHz, RGB cells of a picture 3 mm deep: 0.4 s, 14 us a cell, and 21 us a cell for light that
// goes sideways. Memory: 0.1 kB per cell and channel, 0.3 kB per cell. The same bits for any number of threads.
#pragma once

#include "optics/scene/appearance_model.h"

namespace voxtone::optics {

struct LayeredProfileOptions {
    double known_mm = 0.3;    ///< thickness at which resins are known, > 0
    double bounded_mm = 0.4;  ///< solved together with the surface; thinner where the body is; > 0
    bool sideways = true;     ///< false: a cell sees its own layers alone
};

class LayeredProfileModel final : public AppearanceModel {
public:
    explicit LayeredProfileModel(const LayeredProfileOptions& options = {});
    [[nodiscard]] Appearance predict(const Scene& scene, const Surface& surface,
                                     const Progress* progress = nullptr) const override;

private:
    LayeredProfileOptions options_;
};

}  // namespace voxtone::optics

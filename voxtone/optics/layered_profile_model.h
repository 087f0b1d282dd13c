// SPDX-License-Identifier: GPL-3.0-or-later
//
// The layered profiles of Hasan et al. 2010 as an appearance model: the layers under each surface cell, stacked.
//
// From every face of a cell a walk goes inwards against the cell's normal; what it meets, averaged over the faces, is a mixture
// for every depth. Uniform light sees the first coefficient of every profile alone (k = 0), so a mixture has one K and one S per
// channel: those of its resins (Kubelka and Munk's, known at `known_mm`: layer_profile.h) by volume. The layer next to a surface,
// `surfaced_mm` of it at most, is solved together with the surface in all directions (surfaced_totals), because light that a
// surface lets in is not diffuse.
//
// The walk ends on the other side of thin parts: a surface again, where light leaves, and where the same light enters if it lies
// open; a sheet under the faces on the plane z = 0 sends back nothing or everything. After 15 mm the rest is taken as endless.
//
// What it cannot see: light that goes sideways. A cell of one colour beside another is not changed by it, edges are as sharp as
// cells, no light is lost through the sides of a body, and light that enters a wall from behind is what enters it there
// straight across. Neither does it see that voxels of a halftone are pure: they are mixed. For that there are the transport
// predictor and Monte Carlo. Error on plane-parallel bodies: docs/stack-search.md.
//
// Time on one core of 2.5 GHz: 0.4 s, and 8 us a cell of RGB that is 3 mm deep; memory: the answer. The same bits for any number of
// threads.
#pragma once

#include "voxtone/optics/appearance_model.h"

namespace voxtone::optics {

struct LayeredProfileOptions {
    double known_mm = 0.3;     ///< thickness at which resins are known, > 0
    double surfaced_mm = 0.4;  ///< solved together with the surface; thinner where the body is; > 0
    bool sideways = true;      ///< false: a cell sees its own layers alone
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

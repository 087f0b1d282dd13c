// SPDX-License-Identifier: GPL-3.0-or-later
//
// Runs of voxels of one mixture of resins, halftoned in the print's coordinates.
#pragma once

#include <array>
#include <utility>

#include "halftone/screens/blue_noise_screen.h"
#include "halftone/separation/mixture.h"
#include "io/layers/layer_runs.h"

namespace voxtone::slicer {

class MixtureFill {
public:
    /// `resins`: that are loaded, in [1, halftone::max_resins].
    MixtureFill(const halftone::CumulativeMixture& mixture, int resins, halftone::BlueNoiseScreen screen);

    /// Voxels [begin, end) of row `j` of layer `k` of a part whose corner is at `at` in the print.
    void push(int begin, int end, int j, int k, const std::array<int, 3>& at, io::LayerRuns& out) const;

private:
    halftone::CumulativeMixture mixture_;
    int resins_;
    int pure_ = -1;  ///< the resin that it is of alone; -1: several
    halftone::BlueNoiseScreen screen_;
};

}  // namespace voxtone::slicer

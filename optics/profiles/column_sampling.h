// SPDX-License-Identifier: GPL-3.0-or-later
//
// What lies under a cell of a surface, depth by depth: shares of materials in steps from the surface inwards.
//
// From every face of the cell (16 of them at most) a walk goes inwards against the cell's normal; each step holds what
// the walks meet in its middle. A step is one voxel long, deeper down a sixteenth of the depth. It ends where half of
// the walks have left the body, or after 15 mm: the rest is taken as endless.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "optics/scene/appearance_model.h"

namespace voxtone::optics {

/// What the last step borders on: more of the same, air, or air and a sheet under the faces on the plane z = 0.
enum class LayersEnd { endless, open, black_sheet, white_sheet };

struct MaterialColumn {
    struct Step {
        double mm = 0;
        std::size_t first = 0;  ///< of its shares
    };
    std::vector<Step> steps;
    std::vector<float> shares;  ///< by material, 0 (air) first
    LayersEnd end = LayersEnd::endless;
    double mm = 0;
};

/// The scene must outlive it.
class ColumnSampler {
public:
    explicit ColumnSampler(const Scene& scene);
    void under(const Surface& surface, const SurfaceCell& cell, MaterialColumn& layers) const;

private:
    [[nodiscard]] std::array<double, 3> centre(const SurfaceFace& face) const;
    [[nodiscard]] Material at(const std::array<double, 3>& from, const std::array<float, 3>& normal, double depth,
                              bool& below) const;
    [[nodiscard]] LayersEnd end(bool on_plane) const;

    const Scene& scene_;
    const ResinVolume& volume_;
    std::size_t materials_;
    double step_mm_ = 0;
};

}  // namespace voxtone::optics

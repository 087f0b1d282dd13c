// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a printed body looks like beside what was asked for, judged in windows: Monte Carlo of a whole body would take
// hours.
//
// A window is what is seen of the surface within `radius_mm` of a cell drawn at random by area (normals less than 70
// degrees apart); where more than 5 mm2 of the surface are thin, every second one is drawn there: figures of thin and
// thick parts belong apart. All cells of a window are traced, on the mesh as the body's boundary, relative to the same
// cells of the body all of white (smoothed over the surface by a Gaussian of 0.3 mm, since white light is smooth); the
// eye filter sees the window alone, so that its Gaussians wider than the window act on what of it there is. Judged are
// the cells in the inner half of the radius: with the standard error of the mean over windows, which are independent of
// each other. Sheets that enclose nothing and are printed a voxel thick (--sheet-thickness) are no boundary: the cape
// of the mage is seen half as light as its voxels are.
#pragma once

#include <cstdint>
#include <vector>

#include "judge_slab.h"

namespace voxtone::loop_benchmark {

struct BodyJudgement {
    Judgement cells;                    ///< of all windows, one after the other
    std::vector<std::uint32_t> window;  ///< per cell
    std::vector<char> inner;            ///< per cell: judged
    std::vector<char> thin;             ///< per cell: less than 2 mm of body under it, along the normal
    std::size_t windows = 0;
    double surface_cells = 0;  ///< of the whole body
    double thin_share = 0;     ///< of its area
    struct Solid {
        Eigen::Vector3f target;
        double area_mm2 = 0;
    };
    std::vector<Solid> solids;            ///< the largest first; empty where windows lie anywhere
    std::vector<std::uint32_t> solid_of;  ///< per window
};

struct WindowChoice {
    std::size_t windows = 40;
    double radius_mm = 1.0;
    std::uint64_t seed = 1;
    std::size_t solids =
        0;  ///< windows lie in the middle of so many of the largest solids, as many in each; 0: anywhere
};

[[nodiscard]] BodyJudgement judge_body(const slicer::SliceOptions& options, const Effort& effort,
                                       const WindowChoice& choice);

}  // namespace voxtone::loop_benchmark

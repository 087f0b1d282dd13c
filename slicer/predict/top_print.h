// SPDX-License-Identifier: GPL-3.0-or-later
//
// A slab as it is predicted from above, cell by cell, for photographs to be compared with; and how its colours would
// move were a resin's extinction another.
//
// The latter is a first-order guess by place, no second prediction: the mixture M around a cell (voxels by exp(-depth /
// 0.2 mm)) counts as endless,
//
//   rho = (1 - r) A / (1 - r A),    A = (1 - s)(1 - 0.139 s) / (1 + 1.17 s),    s = sqrt((1 - albedo) / (1 - g albedo))
//
// (H. C. van de Hulst, "Multiple Light Scattering", 1980, of the plane albedo; r as in optics/profiles/saunderson.h),
// albedo that of M by Eq. 7 of Iser, Rittig, Wilkie 2025. What it cannot see: what lies deeper, and beside the cell.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "slicer/predict/predict_job.h"

namespace voxtone::slicer {

/// Rows from the largest y, as pixels of a picture.
struct TopPrint {
    int columns = 0, rows = 0;
    std::array<double, 2> cell_mm{};
    std::vector<Eigen::Vector3f> rgb;            ///< linear sRGB
    std::vector<std::string> resins;             ///< "VeroCyan (C)"
    std::vector<Eigen::Vector3f> by_extinction;  ///< d ln rgb / d ln extinction: [cell * resins + resin]
    optics::Surface surface;
    std::vector<std::size_t> cell_of;  ///< of the surface, which is this one
};

/// Throws what a prediction throws, and InputError for bodies and for slabs with holes.
[[nodiscard]] TopPrint predict_top_print(const PredictOptions& options, Progress& progress);

/// What an eye makes of a picture of these cells, from a distance in mm (halftone/loop/eye_filter.h).
using SeenPicture = std::function<std::vector<Eigen::Vector3f>(std::span<const Eigen::Vector3f>)>;
[[nodiscard]] SeenPicture eye_over(const TopPrint& top, double viewing_distance_mm);

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
//
// A slab as it is predicted from above, cell by cell, for photographs to be compared with; the same by light paths; and
// how its colours move with its resins.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "slicer/predict/body_print.h"
#include "slicer/predict/predict_job.h"
#include "slicer/predict/resin_response.h"

namespace voxtone::slicer {

/// Rows from the largest y, as pixels of a picture.
struct TopPrint {
    int columns = 0, rows = 0;
    std::array<double, 2> cell_mm{};
    std::vector<Eigen::Vector3f> rgb;       ///< linear sRGB, 1 is thick white resin in even light
    std::vector<Eigen::Vector3f> by_paths;  ///< by light paths, of a perfect diffuser's (resin_response.h)
    ResinResponse response;
    optics::ResinSet set;    ///< by which it was predicted
    std::string illuminant;  ///< under which lamp
    optics::Surface surface;
    std::vector<std::size_t> cell_of;  ///< of the surface, which is this one
};

/// Without light paths and response. Throws what a prediction throws, and InputError for bodies and slabs with holes.
[[nodiscard]] TopPrint predict_top_picture(const PredictOptions& options, Progress& progress);
/// The whole of a slab; what is seen from all sides as a body. Throws what a prediction throws.
[[nodiscard]] std::variant<TopPrint, BodyPrint> predict_photographed(const PredictOptions& options, ResinParts parts,
                                                                     Progress& progress);

/// What an eye makes of a picture of these cells, from a distance in mm (halftone/loop/eye_filter.h).
using SeenPicture = std::function<std::vector<Eigen::Vector3f>(std::span<const Eigen::Vector3f>)>;
[[nodiscard]] SeenPicture eye_over(const TopPrint& top, double viewing_distance_mm);
/// The same of any picture: columns, rows, and how large its pixels are.
[[nodiscard]] SeenPicture eye_over(int columns, int rows, const std::array<double, 2>& pixel_mm,
                                   double viewing_distance_mm);

}  // namespace voxtone::slicer

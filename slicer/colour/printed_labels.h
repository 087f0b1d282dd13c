// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which labels of a print can be read: texts letter by letter, codes by a reader.
//
// A letter is what hangs together of a label's ink, with what stands above or below it (i, ä). Its contrast is that of
// the luminances that are predicted on it and on what is no ink within 0.5 mm of it; by which, and by its size, it is
// read stands in type_size.h. One that lies on a spot of its own colour has none, whatever the rest has: black letters
// on the spot of a cow. A code is read in what is predicted of its rectangle, cell by cell.
// What is raised or engraved is told by its shape, and not looked for; nor are decals, and labels in texture
// coordinates.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "io/models/decal.h"
#include "slicer/colour/job_prediction.h"
#include "slicer/options/mark_options.h"

namespace voxtone::slicer {

struct PrintedLabel {
    const MarkOptions* mark = nullptr;
    std::vector<std::uint32_t> cells;  ///< that its rectangle lies on
    std::size_t letters = 0, unread = 0;
    double contrast = 0;   ///< of a text, of the least one
    bool is_read = false;  ///< a code, or all letters
};

/// `decals`: those that the marks became, one each, in mm; `origin_mm`: where the prediction's 0, 0, 0 lies.
[[nodiscard]] std::vector<PrintedLabel> printed_labels(const JobPrediction& prediction,
                                                       std::span<const MarkOptions> marks,
                                                       std::span<const io::Decal> decals,
                                                       const Eigen::Vector3d& origin_mm, double viewing_distance_mm);

}  // namespace voxtone::slicer

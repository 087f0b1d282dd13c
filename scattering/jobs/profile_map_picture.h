// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a profile map keeps of its data, as one picture for people.
#pragma once

#include <cstddef>
#include <optional>

#include "io/pictures/picture_writer.h"
#include "scattering/jobs/profile_map_job.h"

namespace voxtone::scattering {

/// Data, factored, clustered side by side (columns) as the paper's Fig. 7. Rows: albedo in colour; mean distance that
/// light goes; the response of one point on a logarithmic scale of five decades; both of the channel in the middle,
/// from black over red and yellow to white. A margin of one window is cut from the first two where enough is left:
/// light beyond the grid is not known there.
struct ComparisonPicture {
    io::Picture8 picture;
    std::size_t channel = 0, point = 0;          ///< shown
    double least_mm = 0, most_mm = 0;            ///< black and white of the second row
    double least_per_mm2 = 0, most_per_mm2 = 0;  ///< and of the third
};

/// `point`: which response is shown; by default one in the middle.
[[nodiscard]] ComparisonPicture draw_comparison(const io::BssrdfFile& data, const ProfileMapResult& result,
                                                std::optional<std::size_t> point = {});

}  // namespace voxtone::scattering

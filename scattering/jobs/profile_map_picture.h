// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a profile map keeps of its data, as one picture for people.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "io/pictures/picture_writer.h"
#include "scattering/jobs/profile_map_job.h"

namespace voxtone::scattering {

/// Columns side by side as in the paper's Fig. 7. Rows: albedo in colour; mean distance that light goes; the response
/// of one point on a logarithmic scale of five decades; both of the channel in the middle, from black over red and
/// yellow to white. A margin of one window is cut from the first two where enough is left: light beyond the grid is not
/// known there.
struct ComparisonPicture {
    io::Picture8 picture;
    std::size_t channel = 0, point = 0;          ///< shown
    double least_mm = 0, most_mm = 0;            ///< black and white of the second row
    double least_per_mm2 = 0, most_per_mm2 = 0;  ///< and of the third
};

/// Points beside each border of a grid that are not judged: a window, or none where little would be left.
[[nodiscard]] std::uint32_t unjudged_margin(const PointGrid& grid, std::uint32_t radius);

/// What is known of a surface, to be drawn.
struct PictureColumn {
    std::vector<SpreadImages> spreads;  ///< by channel
    std::vector<double> window;         ///< the response of the point, of the channel in the middle
};
template <class Source>
[[nodiscard]] PictureColumn picture_column(const Source& source, std::size_t channels, std::size_t point) {
    PictureColumn column;
    for (std::size_t c = 0; c < channels; ++c) column.spreads.push_back(spread_of(source, c));
    column.window = response_at(source, channels / 2, point);
    return column;
}
[[nodiscard]] std::size_t middle_point(const PointGrid& grid);

/// Limits of the scales are those of the first column.
[[nodiscard]] ComparisonPicture draw_columns(const optics::Channels& channels, const PointGrid& grid,
                                             std::uint32_t radius, std::size_t point,
                                             const std::vector<PictureColumn>& columns);

/// Data, factored, clustered. `point`: which response is shown; by default one in the middle.
[[nodiscard]] ComparisonPicture draw_comparison(const io::BssrdfFile& data, const ProfileMapResult& result,
                                                std::optional<std::size_t> point = {});

}  // namespace voxtone::scattering

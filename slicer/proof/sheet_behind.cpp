// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/proof/sheet_behind.h"

#include "optics/colour/channels.h"
#include "slicer/part/backing_sheet.h"

namespace voxtone::slicer {

SheetBehind::SheetBehind(const BackingChoice& backing, const Box& print)
    : low_(print.low), high_(print.high), even_(backing == optics::Backing::white ? 1 : 0) {
    constexpr double gap_mm = 0.005;  // of air; half of what lies between print and ground
    height_mm_ = low_.z() - gap_mm;
    sheet_ = sheet_under(backing, {high_.x() - low_.x(), high_.y() - low_.y()}, optics::Channels{});
}

bool SheetBehind::meets(const optics::Point& from, const optics::Point& way, double& distance,
                        optics::BoundaryNormals& normals, optics::Light& reflectance) const {
    constexpr double off_the_start = 1e-4;
    if (way[2] == 0) return false;
    const double to_plane = (height_mm_ - from[2]) / way[2], x = from[0] + to_plane * way[0],
                 y = from[1] + to_plane * way[1];
    if (!(to_plane > off_the_start) || x < low_.x() || x > high_.x() || y < low_.y() || y > high_.y()) return false;
    distance = to_plane;
    const optics::Point towards{0, 0, way[2] < 0 ? 1.0 : -1.0};
    normals = {towards, towards};
    for (std::size_t c = 0; c < 3; ++c)
        reflectance[c] = sheet_ ? double(sheet_->at(x - low_.x(), y - low_.y(), c)) : even_;
    return true;
}

}  // namespace voxtone::slicer

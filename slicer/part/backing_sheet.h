// SPDX-License-Identifier: GPL-3.0-or-later
//
// What was said of a sheet under a slab -> how much it sends back, by place and channel.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "optics/colour/channels.h"
#include "optics/scene/sheet.h"
#include "slicer/options/option_values.h"

namespace voxtone::slicer {

/// A reflectance of each channel, in [0, 1], that looks like this colour: of R, G, B these, of others the one that is
/// nearest to grey (least squares).
[[nodiscard]] std::vector<double> reflectance_of(const std::array<double, 3>& linear_rgb,
                                                 const optics::Channels& channels);

/// Null but for a Backing::sheet. `size_mm`: of the slab, along x and y, at whose corner the volume begins. Throws
/// InputError for a picture of another shape, FileError.
[[nodiscard]] std::shared_ptr<const optics::Sheet> sheet_under(const BackingChoice& backing,
                                                               const std::array<double, 2>& size_mm,
                                                               const optics::Channels& channels);

}  // namespace voxtone::slicer

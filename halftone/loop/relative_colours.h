// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a model predicts, read as colours: linear sRGB = M (v / w), M the set's weights of channels
// (optics/colour/spectral_colour.h), v the appearance of a cell by channel, w that of the same place in white resin
// (media-relative), or 1. Also the transpose, which takes a derivative by colour to one by appearance: what the
// adjoint prediction starts from.
//
// A place without any light, w = 0, is black, and nothing can be done about it.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "voxtone/optics/media/resins.h"
#include "voxtone/optics/scene/appearance_model.h"

namespace voxtone::halftone {

class RelativeColours {
public:
    /// `white`: w, cell by cell and channel by channel; empty: 1. Keeps a reference to it.
    RelativeColours(const optics::Channels& channels, const std::vector<float>& white);

    /// Per cell.
    [[nodiscard]] std::vector<Eigen::Vector3f> colours(const optics::Appearance& seen) const;
    /// d F / d v from d F / d colour: [cell * channels + channel].
    [[nodiscard]] std::vector<float> adjoint(std::span<const Eigen::Vector3f> by_colour) const;

private:
    const std::vector<float>& white_;
    std::size_t channels_;
    Eigen::Matrix3Xf weights_;
};

}  // namespace voxtone::halftone

// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a model predicts, read as colours (optics/colour/observed_colour.h): linear sRGB = (M v) / (M w), M the set's
// weights of channels, v the appearance of a cell by channel, w that of the same place in white resin (media-relative);
// M v where no white is given. Also the transpose, which takes a derivative by colour to one by appearance: what the
// adjoint prediction starts from,
//
//   d F / d v = M^T (d F / d colour / (M w)).
//
// A place without any light, M w = 0, is black, and nothing can be done about it.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "optics/colour/observed_colour.h"
#include "optics/scene/appearance_model.h"

namespace voxtone::halftone {

class RelativeColours {
public:
    /// `white`: w, cell by cell and channel by channel; empty: absolute colours. Keeps a reference to it.
    RelativeColours(const optics::Channels& channels, const std::vector<float>& white);

    /// Per cell.
    [[nodiscard]] std::vector<Eigen::Vector3f> colours(const optics::Appearance& seen) const;
    /// d F / d v from d F / d colour: [cell * channels + channel].
    [[nodiscard]] std::vector<float> adjoint(std::span<const Eigen::Vector3f> by_colour) const;

private:
    const std::vector<float>& white_;
    optics::ObservedColour<float> observed_;
};

}  // namespace voxtone::halftone

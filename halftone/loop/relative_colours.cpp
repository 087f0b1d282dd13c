// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/halftone/loop/relative_colours.h"

#include "voxtone/base/parallel.h"
#include "voxtone/optics/colour/spectral_colour.h"

namespace voxtone::halftone {

RelativeColours::RelativeColours(const optics::Channels& channels, const std::vector<float>& white)
    : white_(white),
      channels_(channels.size()),
      weights_(optics::linear_srgb_weights(channels.wavelengths_nm).cast<float>()) {}

std::vector<Eigen::Vector3f> RelativeColours::colours(const optics::Appearance& seen) const {
    std::vector<Eigen::Vector3f> rgb(seen.value.size() / channels_);
    parallel_for(0, rgb.size(), 4096, [&](std::size_t i) {
        Eigen::VectorXf value(static_cast<Eigen::Index>(channels_));
        for (std::size_t c = 0; c < channels_; ++c) {
            const std::size_t at = i * channels_ + c;
            value[static_cast<Eigen::Index>(c)] = white_.empty()   ? seen.value[at]
                                                  : white_[at] > 0 ? seen.value[at] / white_[at]
                                                                   : 0;
        }
        rgb[i] = weights_ * value;
    });
    return rgb;
}

std::vector<float> RelativeColours::adjoint(std::span<const Eigen::Vector3f> by_colour) const {
    std::vector<float> out(by_colour.size() * channels_);
    parallel_for(0, by_colour.size(), 4096, [&](std::size_t i) {
        const Eigen::VectorXf by = weights_.transpose() * by_colour[i];
        for (std::size_t c = 0; c < channels_; ++c) {
            const std::size_t at = i * channels_ + c;
            out[at] = white_.empty()   ? by[static_cast<Eigen::Index>(c)]
                      : white_[at] > 0 ? by[static_cast<Eigen::Index>(c)] / white_[at]
                                       : 0;
        }
    });
    return out;
}

}  // namespace voxtone::halftone

// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/loop/relative_colours.h"

#include "base/parallel.h"

namespace voxtone::halftone {

RelativeColours::RelativeColours(const optics::Channels& channels, const std::vector<float>& white)
    : white_(white), observed_(channels) {}

std::vector<Eigen::Vector3f> RelativeColours::colours(const optics::Appearance& seen) const {
    const std::size_t channels = observed_.channels();
    std::vector<Eigen::Vector3f> rgb(seen.value.size() / channels);
    parallel_for(0, rgb.size(), 4096, [&](std::size_t i) {
        const float* value = seen.value.data() + i * channels;
        rgb[i] = white_.empty() ? observed_.absolute(value) : observed_.relative(value, white_.data() + i * channels);
    });
    return rgb;
}

std::vector<float> RelativeColours::adjoint(std::span<const Eigen::Vector3f> by_colour) const {
    const std::size_t channels = observed_.channels();
    std::vector<float> out(by_colour.size() * channels);
    parallel_for(0, by_colour.size(), 4096, [&](std::size_t i) {
        const std::size_t at = i * channels;
        observed_.adjoint(by_colour[i], white_.empty() ? nullptr : white_.data() + at, out.data() + at);
    });
    return out;
}

}  // namespace voxtone::halftone

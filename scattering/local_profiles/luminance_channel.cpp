// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/local_profiles/luminance_channel.h"

#include <algorithm>

#include "optics/colour/channels.h"

namespace voxtone::scattering {
namespace {

/// Of each channel; they sum to 1.
Eigen::VectorXd luminance_weights(const optics::Channels& channels) {
    return optics::d65_weights(channels).row(1).cwiseMax(0).transpose();
}

}  // namespace

optics::Channels luminance_channel() {
    optics::Channels channels;
    const Eigen::Vector3d white = optics::colorimetric_white(channels.illuminant);
    channels.xyz = {{white.x(), white.y(), white.z()}};
    return channels;
}

bool is_luminance(const optics::Channels& channels) { return channels.is_own() && channels.size() == 1; }

io::BssrdfFile luminance_of(const io::BssrdfFile& data) {
    const Eigen::VectorXd weights = luminance_weights(data.channels);
    io::BssrdfFile out = data;
    out.channels = luminance_channel();
    out.responses.channels.resize(1);
    optics::ChannelResponses& sum = out.responses.channels.front();
    std::fill(sum.pairs.begin(), sum.pairs.end(), 0.0f);
    std::fill(sum.total.begin(), sum.total.end(), 0.0f);
    sum.noise = 0;
    for (std::size_t c = 0; c < data.responses.channels.size(); ++c) {
        const optics::ChannelResponses& channel = data.responses.channels[c];
        const double weight = weights[static_cast<Eigen::Index>(c)];
        for (std::size_t i = 0; i < sum.pairs.size(); ++i)
            sum.pairs[i] += static_cast<float>(weight) * channel.pairs[i];
        for (std::size_t i = 0; i < sum.total.size(); ++i)
            sum.total[i] += static_cast<float>(weight) * channel.total[i];
        sum.noise += weight * weight * channel.noise;
    }
    return out;
}

io::ProfileMap asked_of(const optics::Channels& channels, io::ProfileMap map) {
    if (!is_luminance(map.channels)) return map;
    map.channels = channels;
    for (auto& target : map.target) target.resize(channels.size(), optics::RadialSamples(target.front()));
    return map;
}

io::BssrdfFile asked_of(const optics::Channels& channels, io::BssrdfFile data) {
    if (!is_luminance(data.channels)) return data;
    data.channels = channels;
    auto& all = data.responses.channels;
    all.resize(channels.size(), optics::ChannelResponses(all.front()));
    return data;
}

}  // namespace voxtone::scattering

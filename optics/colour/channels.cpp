// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/colour/channels.h"

#include <cmath>

#include <fmt/format.h>
#include <Eigen/LU>

#include "base/contracts.h"
#include "optics/colour/colour.h"

namespace voxtone::optics {

namespace {

std::optional<std::string> fault_of_wavelengths(const std::vector<double>& nm) {
    for (std::size_t i = 0; i < nm.size(); ++i)
        if (!(nm[i] > 0 && std::isfinite(nm[i])) || (i > 0 && !(nm[i] > nm[i - 1])))
            return fmt::format("wavelength number {} is {} nm; wavelengths must be positive and rise", i + 1, nm[i]);
    return std::nullopt;
}

}  // namespace

std::optional<std::string> fault_of(const Channels& channels) {
    VOXTONE_EXPECT(channels.wavelengths_nm.empty() || channels.xyz.empty());
    if (!channels.is_own()) return fault_of_wavelengths(channels.wavelengths_nm);
    // Those that a printer has are at most max_own_channels; wavelengths under a lamp (lamp.h) are more.
    constexpr std::size_t most = 256;
    if (channels.size() > most) return fmt::format("there are {} channels; at most {} can be", channels.size(), most);
    const Eigen::Vector3d white = colorimetric_white(channels.illuminant);
    for (std::size_t k = 0; k < 3; ++k) {
        double sum = 0;
        for (const auto& weight : channels.xyz) sum += weight[k];
        if (const double wanted = white[static_cast<Eigen::Index>(k)]; !(std::abs(sum - wanted) <= 1e-4))
            return fmt::format(
                "the channels' weights to {} sum to {}, but the white of {} has {}: a perfect diffuser, 1 in every "
                "channel, must be white; scale the weights, or name the illuminant that they are for",
                "XYZ"[k], sum, name_of(channels.illuminant), wanted);
    }
    return std::nullopt;
}

Channels colorimetric_channels(Illuminant illuminant) {
    const Eigen::Vector3d white = colorimetric_white(illuminant);
    Channels channels;
    channels.xyz = {{white.x(), 0, 0}, {0, white.y(), 0}, {0, 0, white.z()}};
    channels.illuminant = illuminant;
    return channels;
}

const Channels& wide_channels() {
    static const Channels wide = [] {
        Eigen::Matrix3d primaries;  // X, Y, Z of each for Y / y = 1
        primaries << 0.7347, 0.1596, 0.0366, 0.2653, 0.8404, 0.0001, 0, 0, 0.9633;
        const Eigen::Vector3d amounts = primaries.inverse() * d50_white();
        Channels channels;
        for (Eigen::Index c = 0; c < 3; ++c) {
            const Eigen::Vector3d xyz = amounts[c] * primaries.col(c);
            channels.xyz.push_back({xyz[0], xyz[1], xyz[2]});
        }
        return channels;
    }();
    return wide;
}

std::string channel_name(const Channels& channels, std::size_t channel) {
    VOXTONE_EXPECT(channel < channels.size());
    if (channels.is_rgb()) return std::string(1, "RGB"[channel]);
    if (channels.is_own()) return fmt::format("channel {}", channel + 1);
    return fmt::format("{} nm", channels.wavelengths_nm[channel]);
}

std::string channel_word(const Channels& channels, std::size_t channel) {
    VOXTONE_EXPECT(channel < channels.size());
    if (channels.is_own()) return fmt::format("c{}", channel + 1);
    return channels.is_rgb() ? channel_name(channels, channel)
                             : fmt::format("{:g}nm", channels.wavelengths_nm[channel]);
}

std::string channels_text(const Channels& channels) {
    if (channels.is_rgb()) return "R, G, B";
    if (channels.is_own()) return fmt::format("{} channels of their own", channels.size());
    return fmt::format("{} wavelengths from {} to {} nm", channels.size(), channels.wavelengths_nm.front(),
                       channels.wavelengths_nm.back());
}

Eigen::Matrix3Xd linear_srgb_weights(const Channels& channels) {
    if (!channels.is_own()) return linear_srgb_weights(channels.wavelengths_nm);
    const Eigen::Vector3d white = colorimetric_white(channels.illuminant);
    Eigen::Matrix3Xd weights(3, static_cast<Eigen::Index>(channels.size()));
    for (std::size_t c = 0; c < channels.size(); ++c)
        weights.col(static_cast<Eigen::Index>(c)) = linear_srgb_from_xyz(
            adapt_white(Eigen::Map<const Eigen::Vector3d>(channels.xyz[c].data()), white, d65_white()));
    return weights;
}

Eigen::Matrix3d linear_srgb_of(const Eigen::Vector3d& white) {
    Eigen::Matrix3d map;
    for (Eigen::Index k = 0; k < 3; ++k)
        map.col(k) = linear_srgb_from_xyz(adapt_white(Eigen::Vector3d::Unit(k), white, d65_white()));
    return map;
}

Eigen::Matrix3Xd d65_weights(const Channels& channels) {
    return xyz_from_linear_srgb_matrix() * linear_srgb_weights(channels);
}

Eigen::Vector3d colorimetric_white(Illuminant illuminant) {
    switch (illuminant) {
        case Illuminant::d50:
            return d50_white();
        case Illuminant::d65:
            return d65_white();
        case Illuminant::a:
            return {1.09850, 1.0, 0.35585};  // CIE 15:2018, Table 6.2
    }
    VOXTONE_EXPECT(!"an illuminant that is known");
    return d65_white();
}

}  // namespace voxtone::optics

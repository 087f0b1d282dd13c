// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/optics/colour/channels.h"

#include <fmt/format.h>

#include "voxtone/base/contracts.h"
#include "voxtone/optics/colour/colour.h"

namespace voxtone::optics {

Channels colorimetric_channels(Illuminant illuminant) {
    const Eigen::Vector3d white = colorimetric_white(illuminant);
    Channels channels;
    channels.xyz = {{white.x(), 0, 0}, {0, white.y(), 0}, {0, 0, white.z()}};
    channels.illuminant = illuminant;
    return channels;
}

std::string channel_name(const Channels& channels, std::size_t channel) {
    VOXTONE_EXPECT(channel < channels.size());
    if (channels.is_rgb()) return std::string(1, "RGB"[channel]);
    if (channels.is_own()) return fmt::format("channel {}", channel + 1);
    return fmt::format("{} nm", channels.wavelengths_nm[channel]);
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

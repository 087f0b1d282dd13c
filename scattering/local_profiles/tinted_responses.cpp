// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/local_profiles/tinted_responses.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "optics/colour/channels.h"
#include "scattering/local_profiles/luminance_channel.h"

namespace voxtone::scattering {

io::BssrdfFile tinted(io::BssrdfFile data, const io::Texture& picture) {
    data = asked_of(optics::Channels(), std::move(data));
    if (!data.channels.is_rgb())
        throw InputError(
            fmt::format("--tint: a picture has red, green and blue, the data {}; make them with these "
                        "channels, or of luminance",
                        optics::channels_text(data.channels)));
    optics::SampledBssrdf& responses = data.responses;
    const std::size_t points = responses.points();
    // The level whose texels are as wide as a point's cell.
    const float lod = std::log2(std::max(1.0F, static_cast<float>(picture.width_px()) / float(responses.width)));
    std::vector<Eigen::Vector3f> colour;
    for (std::uint32_t y = 0; y < responses.height; ++y)
        for (std::uint32_t x = 0; x < responses.width; ++x)
            colour.push_back(picture.sample((float(x) + 0.5F) / float(responses.width),
                                            1 - (float(y) + 0.5F) / float(responses.height), lod));
    const auto offsets = optics::half_window(responses.radius);
    const auto width = static_cast<int>(responses.width), height = static_cast<int>(responses.height);
    for (std::size_t c = 0; c < responses.channels.size(); ++c) {
        const auto t = [&](std::size_t point) {
            return std::clamp(colour[point][static_cast<Eigen::Index>(c)], 0.0F, 1.0F);
        };
        optics::ChannelResponses& channel = responses.channels[c];
        const std::vector<double> before = optics::light_within_window(responses, c);
        for (std::size_t k = 0; k < offsets.size(); ++k)
            for (std::size_t from = 0; from < points; ++from) {
                const int column = static_cast<int>(from) % width + offsets[k].x,
                          row = static_cast<int>(from) / width + offsets[k].y;
                if (column < 0 || column >= width || row >= height) continue;
                channel.pairs[k * points + from] *=
                    std::sqrt(t(from) * t(static_cast<std::size_t>(row * width + column)));
            }
        const std::vector<double> within = optics::light_within_window(responses, c);
        for (std::size_t i = 0; i < points; ++i)  // what leaves beyond the window: by its own colour
            channel.total[i] =
                static_cast<float>(within[i]) + t(i) * std::max(0.0F, channel.total[i] - static_cast<float>(before[i]));
    }
    return data;
}

}  // namespace voxtone::scattering

// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/channel_json.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

namespace voxtone::io {

optics::Channels channels_of(const JsonObject& json) {
    optics::Channels channels;
    if (json.is_text("channels")) {
        if (json.text("channels") != "rgb")
            json.fail("channels", fmt::format("is {}, expected \"rgb\" or a list of wavelengths in nm",
                                              json_text(json.text("channels"))));
        return channels;
    }
    channels.wavelengths_nm = json.numbers("channels", 0, 1, 1e5);
    if (channels.wavelengths_nm.empty() || channels.wavelengths_nm.size() > 256)
        json.fail("channels", fmt::format("has {} wavelengths, expected 1 to 256", channels.wavelengths_nm.size()));
    return channels;
}

std::string channels_json(const optics::Channels& channels) {
    return channels.is_rgb() ? std::string("\"rgb\"") : fmt::format("[{}]", fmt::join(channels.wavelengths_nm, ", "));
}

}  // namespace voxtone::io

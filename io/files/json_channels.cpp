// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/files/json_channels.h"

#include <algorithm>
#include <functional>

#include <fmt/format.h>

#include "voxtone/base/printable.h"

namespace voxtone::io {

namespace {

constexpr std::size_t most_wavelengths = 256;

}  // namespace

optics::Channels json_channels(const JsonObject& json, std::string_view key) {
    if (json.is_text(key)) {
        if (json.text(key) != "rgb")
            json.fail(key, fmt::format("is {}, expected \"rgb\" or a list of wavelengths in nm",
                                       json_quoted(json.text(key))));
        return {};
    }
    optics::Channels channels{json.numbers(key, 0, 1, 1e5)};
    const std::vector<double>& nm = channels.wavelengths_nm;
    if (nm.empty() || nm.size() > most_wavelengths)
        json.fail(key, fmt::format("has {} wavelengths, expected \"rgb\" or 1 to {} of them in nm", nm.size(),
                                   most_wavelengths));
    if (std::adjacent_find(nm.begin(), nm.end(), std::greater_equal<>()) != nm.end())
        json.fail(key, "holds wavelengths that do not rise");
    return channels;
}

void write_channels(JsonWriter& json, const optics::Channels& channels) {
    if (channels.is_rgb())
        json.value("rgb");
    else
        json.value(channels.wavelengths_nm);
}

}  // namespace voxtone::io

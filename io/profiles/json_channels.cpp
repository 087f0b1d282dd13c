// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/profiles/json_channels.h"

#include <algorithm>
#include <functional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/printable.h"

namespace voxtone::io {

namespace {

constexpr std::size_t most_wavelengths = 256;
constexpr double most_weight = 1e6;

optics::Illuminant json_illuminant(const JsonObject& json) {
    const std::string name = json.text("illuminant");
    if (const auto illuminant = value_of<optics::Illuminant>(name)) return *illuminant;
    json.fail("illuminant", fmt::format("is {}, expected one of {}: without it the weights mean no colour",
                                        json_quoted(name), fmt::join(names_of<optics::Illuminant>(), ", ")));
}

}  // namespace

optics::Channels json_channels(const JsonObject& json, std::string_view key) {
    if (json.is_text(key)) {
        if (json.text(key) != "rgb")
            json.fail(key, fmt::format("is {}, expected \"rgb\" or a list of wavelengths in nm",
                                       json_quoted(json.text(key))));
        return {};
    }
    if (json.is_object(key)) return json_own_channels(json.object(key));
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
    else if (channels.is_own())
        write_own_channels(json, channels);
    else
        json.value(channels.wavelengths_nm);
}

optics::Channels json_own_channels(const JsonObject& json) {
    json.allow_only({"kind", "illuminant", "xyz"});
    if (json.text("kind") != "own")
        json.fail("kind", fmt::format("is {}, expected \"own\": channels by their weights to XYZ",
                                      json_quoted(json.text("kind"))));
    optics::Channels channels;
    channels.illuminant = json_illuminant(json);
    const auto rows = json.number_lists("xyz", 0, -most_weight, most_weight);
    if (rows.empty() || rows.size() > optics::max_own_channels)
        json.fail("xyz", fmt::format("has {} rows, expected one for each channel, 1 to {}", rows.size(),
                                     optics::max_own_channels));
    for (std::size_t c = 0; c < rows.size(); ++c) {
        if (rows[c].size() != 3)
            json.fail(fmt::format("xyz[{}]", c),
                      fmt::format("has {} numbers, expected 3: the channel's weights to X, Y and Z", rows[c].size()));
        channels.xyz.push_back({rows[c][0], rows[c][1], rows[c][2]});
    }
    if (const auto fault = fault_of(channels)) json.fail("xyz", *fault);
    return channels;
}

void write_own_channels(JsonWriter& json, const optics::Channels& channels) {
    json.begin_object().add("kind", "own").add("illuminant", name_of(channels.illuminant));
    json.add("xyz", channels.xyz).end_object();
}

}  // namespace voxtone::io

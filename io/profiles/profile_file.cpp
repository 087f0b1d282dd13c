// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/profiles/profile_file.h"

#include <limits>

#include <fmt/format.h>

#include "voxtone/base/contracts.h"
#include "voxtone/io/files/json_channels.h"
#include "voxtone/io/files/json_object.h"

namespace voxtone::io {
namespace {

constexpr double shortest_mm = 1e-6, longest_mm = 1e6;
constexpr double any = std::numeric_limits<double>::max();
constexpr std::size_t fewest_samples = 4;

using Lists = std::vector<std::vector<double>>;

std::vector<optics::RadialSamples> samples_from(const JsonObject& json, std::size_t channels) {
    json.allow_only({"spacing_mm", "light", "error", "total"});
    const double spacing = json.number("spacing_mm", shortest_mm, longest_mm);
    const Lists light = json.number_lists("light", channels, -any, any);
    for (const auto& channel : light) {
        if (channel.size() < fewest_samples)
            json.fail("light",
                      fmt::format("has {} samples in a channel; at least {} are needed to know how light falls off",
                                  channel.size(), fewest_samples));
        if (channel.size() != light[0].size())
            json.fail("light", fmt::format("has {} samples in one channel and {} in another; all channels have as many",
                                           light[0].size(), channel.size()));
    }
    Lists error;
    if (json.has("error")) error = json.number_lists("error", channels, 0, any);
    for (const auto& channel : error)
        if (channel.size() != light[0].size())
            json.fail("error",
                      fmt::format("has {} values for {} samples in a channel; give one for each, or leave the key out",
                                  channel.size(), light[0].size()));
    std::vector<double> total;
    if (json.has("total")) total = json.numbers("total", channels, 0, 1);
    std::vector<optics::RadialSamples> samples;
    for (std::size_t c = 0; c < channels; ++c) {
        samples.push_back({spacing, light[c]});
        if (!total.empty()) samples[c].total = total[c];
        if (!error.empty()) samples[c].error = error[c];
    }
    return samples;
}

ProfileFile profile_from_json(const JsonObject& json) {
    json.allow_only({"format", "version", "name", "source", "channels", "thickness_mm", "R", "T"});
    if (json.text("format") != "voxtone-profile")
        json.fail("format", "is not \"voxtone-profile\": this is no scattering profile");
    if (json.integer("version", 0, 1000000) != 1) json.fail("version", "is not 1, the only version this program knows");
    ProfileFile file;
    file.name = json.text("name");
    if (json.has("source")) file.source = json.text("source");
    file.channels = json_channels(json, "channels");
    const std::size_t channels = file.channels.size();
    // A layer is known by its thickness, R and T together; a target by R alone.
    const bool layer = json.has("T") || json.has("thickness_mm");
    const double thickness = layer ? json.number("thickness_mm", shortest_mm, longest_mm) : 0;
    const auto R = samples_from(json.object("R"), channels);
    const auto T = layer ? samples_from(json.object("T"), channels) : std::vector<optics::RadialSamples>(channels);
    for (std::size_t c = 0; c < channels; ++c) file.by_channel.push_back({thickness, T[c], R[c]});
    return file;
}

std::string list_text(const std::vector<double>& values) { return fmt::format("[{}]", fmt::join(values, ", ")); }

// Of one side, all channels.
std::string samples_text(const std::vector<optics::RadialSamples>& channels) {
    const optics::RadialSamples& first = channels[0];
    std::vector<double> totals;
    std::string light, error;
    for (const auto& samples : channels) {
        VOXTONE_EXPECT(samples.spacing_mm == first.spacing_mm && samples.light.size() == first.light.size() &&
                       samples.error.size() == first.error.size() &&
                       samples.total.has_value() == first.total.has_value());
        if (samples.total) totals.push_back(*samples.total);
        const char* between = light.empty() ? "\n   " : ",\n   ";
        light += between + list_text(samples.light);
        error += between + list_text(samples.error);
    }
    std::string text = fmt::format("{{\"spacing_mm\": {}", first.spacing_mm);
    if (first.total) text += fmt::format(", \"total\": {}", list_text(totals));
    text += fmt::format(",\n  \"light\": [{}]", light);
    if (!first.error.empty()) text += fmt::format(",\n  \"error\": [{}]", error);
    return text + "}";
}

}  // namespace

ProfileFile parse_profile(std::string_view text, std::string source) {
    return profile_from_json(JsonObject::parse(text, std::move(source)));
}

ProfileFile read_profile(const std::filesystem::path& file) { return profile_from_json(JsonObject::read(file)); }

std::string profile_text(const ProfileFile& file) {
    VOXTONE_EXPECT(file.by_channel.size() == file.channels.size());
    std::string text = fmt::format(
        "{{\"format\": \"voxtone-profile\", \"version\": 1, \"name\": {},\n \"source\": {},\n \"channels\": {}",
        json_text(file.name), json_text(file.source), channels_json(file.channels));
    std::vector<optics::RadialSamples> R, T;
    for (const auto& channel : file.by_channel) R.push_back(channel.R), T.push_back(channel.T);
    if (!file.is_target()) text += fmt::format(", \"thickness_mm\": {}", file.by_channel[0].thickness_mm);
    text += ",\n \"R\": " + samples_text(R);
    if (!file.is_target()) text += ",\n \"T\": " + samples_text(T);
    return text + "}\n";
}

}  // namespace voxtone::io

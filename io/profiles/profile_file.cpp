// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/profiles/profile_file.h"

#include <limits>

#include <fmt/format.h>

#include "base/contracts.h"
#include "io/files/json_object.h"
#include "io/files/json_writer.h"
#include "io/profiles/json_channels.h"

namespace voxtone::io {
namespace {

constexpr double shortest_mm = 1e-6, longest_mm = 1e6;
constexpr double any_value = std::numeric_limits<double>::max();
constexpr std::size_t fewest_samples = 4;

using Lists = std::vector<std::vector<double>>;

std::vector<optics::RadialSamples> samples_from(const JsonObject& json, std::size_t channels) {
    json.allow_only({"spacing_mm", "light", "error", "total"});
    const double spacing = json.number("spacing_mm", shortest_mm, longest_mm);
    const Lists light = json.number_lists("light", channels, -any_value, any_value);
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
    if (json.has("error")) error = json.number_lists("error", channels, 0, any_value);
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

void write_lists(JsonWriter& json, const Lists& lists) {
    json.begin_list();
    for (const auto& list : lists) json.line().value(list);
    json.end_list();
}

/// Of one side, all channels.
void write_samples(JsonWriter& json, const std::vector<optics::RadialSamples>& channels) {
    const optics::RadialSamples& first = channels[0];
    std::vector<double> totals;
    Lists light, error;
    for (const auto& samples : channels) {
        VOXTONE_EXPECT(samples.spacing_mm == first.spacing_mm && samples.light.size() == first.light.size() &&
                       samples.error.size() == first.error.size() &&
                       samples.total.has_value() == first.total.has_value());
        if (samples.total) totals.push_back(*samples.total);
        light.push_back(samples.light);
        error.push_back(samples.error);
    }
    json.begin_object().add("spacing_mm", first.spacing_mm);
    if (first.total) json.add("total", totals);
    write_lists(json.line().key("light"), light);
    if (!first.error.empty()) write_lists(json.line().key("error"), error);
    json.end_object();
}

}  // namespace

ProfileFile parse_profile(std::string_view text, std::string source) {
    return profile_from_json(JsonObject::parse(text, std::move(source)));
}

ProfileFile read_profile(const std::filesystem::path& file) { return profile_from_json(JsonObject::read(file)); }

std::string profile_text(const ProfileFile& file) {
    VOXTONE_EXPECT(file.by_channel.size() == file.channels.size());
    std::vector<optics::RadialSamples> R, T;
    for (const auto& channel : file.by_channel) R.push_back(channel.R), T.push_back(channel.T);
    JsonWriter json;
    json.begin_object().add("format", "voxtone-profile").add("version", 1).add("name", file.name);
    json.line().add("source", file.source);
    write_channels(json.line().key("channels"), file.channels);
    if (!file.is_target()) json.add("thickness_mm", file.by_channel[0].thickness_mm);
    write_samples(json.line().key("R"), R);
    if (!file.is_target()) write_samples(json.line().key("T"), T);
    json.end_object();
    return json.text() + "\n";
}

}  // namespace voxtone::io

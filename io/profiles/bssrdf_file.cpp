// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/profiles/bssrdf_file.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "base/contracts.h"
#include "base/error.h"
#include "io/files/json_object.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "io/profiles/json_channels.h"

namespace voxtone::io {
namespace {

static_assert(std::endian::native == std::endian::little, "floats are copied as they are");

constexpr std::string_view magic = "VTBSSRDF";
constexpr std::size_t header_begin = magic.size() + 4, most_header = 1 << 16;
constexpr std::uint64_t most_side = 4096, most_radius = 64;
constexpr double most_total = 1.02, most_light = 1e12;

std::span<const float> floats_at(std::span<const std::uint8_t>& bytes, std::vector<float>& out, std::size_t count) {
    out.resize(count);
    std::memcpy(out.data(), bytes.data(), 4 * count);
    bytes = bytes.subspan(4 * count);
    return out;
}

void check_values(std::span<const float> values, double most, const char* what, std::size_t channel, std::size_t points,
                  const std::string& name) {
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!(values[i] >= 0 && values[i] <= most))
            throw InputError(fmt::format(
                "{}: {} of channel {}, picture {}, point {} is {}, expected 0 to {}; the file may be damaged or "
                "in other units: make it anew",
                name, what, channel, i / points, i % points, values[i], most));
}

void append(std::vector<std::uint8_t>& bytes, const void* data, std::size_t size) {
    const auto* first = static_cast<const std::uint8_t*>(data);
    bytes.insert(bytes.end(), first, first + size);
}

}  // namespace

std::uint64_t bssrdf_bytes(std::uint64_t channels, std::uint64_t width, std::uint64_t height, std::uint32_t radius) {
    return 4 * channels * width * height * (1 + optics::half_window(radius).size());
}

BssrdfFile read_bssrdf(const std::filesystem::path& file) {
    const std::string name = file.string();
    const auto whole = read_whole_file(file, most_bssrdf_bytes + most_header + header_begin);
    if (whole.size() < header_begin || std::memcmp(whole.data(), magic.data(), magic.size()) != 0)
        throw InputError(fmt::format("{}: does not begin with {}: this is no data set of scattering", name, magic));
    std::uint32_t header_size = 0;
    std::memcpy(&header_size, whole.data() + magic.size(), 4);
    if (header_size > most_header || header_size > whole.size() - header_begin)
        throw InputError(
            fmt::format("{}: claims a header of {} bytes, which it does not have; it may be cut short: make it anew",
                        name, header_size));
    const JsonObject json =
        JsonObject::parse({reinterpret_cast<const char*>(whole.data()) + header_begin, header_size}, name);
    json.allow_only({"format", "version", "source", "channels", "points", "pitch_mm", "radius", "noise"});
    if (json.text("format") != "voxtone-bssrdf")
        json.fail("format", "is not \"voxtone-bssrdf\": this is no data set of scattering");
    if (json.integer("version", 0, 1000000) != 1) json.fail("version", "is not 1, the only version this program knows");
    BssrdfFile data;
    if (json.has("source")) data.source = json.text("source");
    data.channels = json_channels(json, "channels");
    optics::SampledBssrdf& responses = data.responses;
    const auto points = json.integers("points", 2, 1, most_side);
    responses.width = static_cast<std::uint32_t>(points[0]);
    responses.height = static_cast<std::uint32_t>(points[1]);
    responses.pitch_mm = json.number("pitch_mm", 1e-6, 1e6);
    responses.radius = static_cast<std::uint32_t>(json.integer("radius", 1, most_radius));
    const auto noise = json.numbers("noise", data.channels.size(), 0, most_light);

    std::span<const std::uint8_t> rest = std::span(whole).subspan(header_begin + header_size);
    const std::uint64_t expected = bssrdf_bytes(data.channels.size(), points[0], points[1], responses.radius);
    if (rest.size() != expected)
        throw InputError(fmt::format(
            "{}: has {} bytes behind its header, {} x {} points, radius {}, {} channels make {}; it may be cut "
            "short: make it anew",
            name, rest.size(), points[0], points[1], responses.radius, data.channels.size(), expected));
    const std::size_t count = responses.points(), pairs = count * optics::half_window(responses.radius).size();
    for (std::size_t c = 0; c < data.channels.size(); ++c) {
        optics::ChannelResponses& channel = responses.channels.emplace_back();
        channel.noise = noise[c];
        check_values(floats_at(rest, channel.total, count), most_total, "a total", c, count, name);
        check_values(floats_at(rest, channel.pairs, pairs), most_light, "light", c, count, name);
    }
    return data;
}

void write_bssrdf(const BssrdfFile& data, const std::filesystem::path& file) {
    const optics::SampledBssrdf& responses = data.responses;
    VOXTONE_EXPECT(responses.channels.size() == data.channels.size());
    VOXTONE_EXPECT(responses.width >= 1 && responses.width <= most_side && responses.height >= 1 &&
                   responses.height <= most_side);
    VOXTONE_EXPECT(responses.radius >= 1 && responses.radius <= most_radius);
    std::vector<double> noise;
    for (const auto& channel : responses.channels) noise.push_back(channel.noise);
    JsonWriter json;
    json.begin_object().add("format", "voxtone-bssrdf").add("version", 1).add("source", data.source);
    write_channels(json.key("channels"), data.channels);
    json.line().add("points", std::array{responses.width, responses.height}).add("pitch_mm", responses.pitch_mm);
    json.add("radius", responses.radius).add("noise", noise).end_object();
    const std::string header = json.text() + "\n";
    VOXTONE_EXPECT(header.size() <= most_header);
    const std::uint64_t size = bssrdf_bytes(data.channels.size(), responses.width, responses.height, responses.radius);
    VOXTONE_EXPECT(size <= most_bssrdf_bytes);
    std::vector<std::uint8_t> bytes;
    bytes.reserve(static_cast<std::size_t>(size) + header_begin + header.size());
    append(bytes, magic.data(), magic.size());
    const auto header_size = static_cast<std::uint32_t>(header.size());
    append(bytes, &header_size, 4);
    append(bytes, header.data(), header.size());
    for (const auto& channel : responses.channels) {
        VOXTONE_EXPECT(channel.total.size() == responses.points());
        VOXTONE_EXPECT(channel.pairs.size() == responses.points() * optics::half_window(responses.radius).size());
        append(bytes, channel.total.data(), 4 * channel.total.size());
        append(bytes, channel.pairs.data(), 4 * channel.pairs.size());
    }
    write_whole_file(file, bytes);
}

}  // namespace voxtone::io

// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/report/viewer_data.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <tuple>
#include <vector>

#include "base/contracts.h"
#include "base/parallel.h"
#include "io/files/base64.h"
#include "io/files/deflate.h"
#include "io/files/json_writer.h"

namespace voxtone::io {

namespace {

using Bytes = std::vector<std::uint8_t>;

std::string base64_of(std::span<const std::byte> bytes) {
    return base64({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

std::string packed(const Bytes& bytes) {
    constexpr int level = 6;
    return base64_of(deflated(std::as_bytes(std::span(bytes)), level));
}

/// Channel by channel, each the difference to the place before.
std::string packed_colours(const Bytes& rgb) {
    Bytes bytes;
    bytes.reserve(rgb.size());
    for (std::size_t c = 0; c < 3; ++c) {
        std::uint8_t before = 0;
        for (std::size_t i = c; i < rgb.size(); i += 3) {
            bytes.push_back(static_cast<std::uint8_t>(rgb[i] - before));
            before = rgb[i];
        }
    }
    return packed(bytes);
}

std::string packed_positions(const std::vector<std::uint16_t>& positions) {
    const std::size_t count = positions.size() / 3;
    Bytes bytes(2 * positions.size());
    for (std::size_t c = 0; c < 3; ++c) {
        std::uint16_t before = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint16_t now = positions[3 * i + c];
            const auto by = static_cast<std::uint16_t>(now - before);
            bytes[2 * c * count + i] = static_cast<std::uint8_t>(by & 0xff);
            bytes[(2 * c + 1) * count + i] = static_cast<std::uint8_t>(by >> 8);
            before = now;
        }
    }
    return packed(bytes);
}

std::string packed_triangles(const std::vector<std::uint32_t>& triangles) {
    Bytes bytes;
    bytes.reserve(2 * triangles.size());
    std::int64_t before = 0;
    for (const std::uint32_t index : triangles) {
        const std::int64_t by = index - before;
        for (auto rest = static_cast<std::uint64_t>(by < 0 ? -2 * by - 1 : 2 * by);; rest >>= 7) {
            bytes.push_back(static_cast<std::uint8_t>((rest & 0x7f) | (rest > 0x7f ? 0x80 : 0)));
            if (rest <= 0x7f) break;
        }
        before = index;
    }
    return packed(bytes);
}

/// Low bytes of all numbers, then high bytes.
std::string packed_numbers(const std::vector<std::uint16_t>& numbers) {
    Bytes bytes;
    for (const int shift : {0, 8})
        for (const std::uint16_t number : numbers) bytes.push_back(static_cast<std::uint8_t>(number >> shift));
    return packed(bytes);
}

void add_parts(JsonWriter& json, const ViewerSurface& s) {
    if (s.parts.empty()) return;
    VOXTONE_EXPECT(s.part_of.size() == s.covered.size());
    json.add("part_of", packed_numbers(s.part_of)).key("parts").begin_list();
    for (const ViewerPart& part : s.parts) {
        json.begin_object().add("name", part.name).key("figures").begin_list();
        for (const auto& [what, text] : part.figures)
            json.begin_object().add("what", what).add("text", text).end_object();
        json.end_list().key("shares").begin_list();
        for (const auto& [resin, share] : part.shares)
            json.begin_object().add("resin", resin).add("share", share).end_object();
        json.end_list().end_object();
    }
    json.end_list();
}

/// What of a surface is deflated.
struct PackedSurface {
    std::string covered, positions, triangles;
    std::vector<std::string> looks;
    std::array<std::string, 2> differences;  ///< seen, single
};

PackedSurface packed_surface(const ViewerSurface& s) {
    PackedSurface to;
    to.looks.resize(s.looks.size());
    constexpr std::size_t others = 5;
    parallel_for(0, others + s.looks.size(), 1, [&](std::size_t i) {
        switch (i) {
            case 0:
                if (s.is_picture()) to.covered = packed(s.covered);
                return;
            case 1:
                if (!s.is_picture()) to.positions = packed_positions(s.positions);
                return;
            case 2:
                if (!s.is_picture()) to.triangles = packed_triangles(s.triangles);
                return;
            case 3:
                if (!s.seen.empty()) to.differences[0] = packed(s.seen);
                return;
            case 4:
                if (!s.single.empty()) to.differences[1] = packed(s.single);
                return;
            default:
                to.looks[i - others] = packed_colours(s.looks[i - others].rgb);
        }
    });
    return to;
}

void add_surface(JsonWriter& json, const ViewerSurface& s) {
    const std::size_t places = s.is_picture() ? std::size_t{s.size_px[0]} * s.size_px[1] : s.positions.size() / 3;
    for (const ViewerLook& look : s.looks) VOXTONE_EXPECT(look.rgb.size() == 3 * places);
    const PackedSurface packed = packed_surface(s);
    json.line().key("surface").begin_object();
    json.add("low_mm", s.low_mm).add("high_mm", s.high_mm).add("place_mm", s.place_mm).add("places", places);
    if (s.is_picture()) {
        json.add("size_px", s.size_px).add("covered", packed.covered);
        add_parts(json, s);
    } else {
        json.add("positions", packed.positions);
        VOXTONE_EXPECT(s.clear <= s.triangles.size() && s.clear % 3 == 0);
        json.add("indices", s.triangles.size()).add("triangles", packed.triangles);
        if (s.clear > 0) json.add("clear", s.clear);
    }
    json.add("asked", s.asked).add("expected", s.expected).add("to_scale", s.to_scale);
    json.add("note", s.note).key("looks").begin_list();
    for (std::size_t i = 0; i < s.looks.size(); ++i) {
        json.begin_object().add("name", s.looks[i].name).add("caption", s.looks[i].caption);
        json.add("rgb", packed.looks[i]).end_object();
    }
    json.end_list();
    for (const auto& [name, differences, text] : {std::tuple{"seen", &s.seen, &packed.differences[0]},
                                                  std::tuple{"single", &s.single, &packed.differences[1]}}) {
        if (differences->empty()) continue;
        VOXTONE_EXPECT(differences->size() == places);
        json.add(name, *text);
    }
    json.end_object();
}

void add_layers(JsonWriter& json, const char* name, const std::vector<ViewerLayer>& layers) {
    json.line().key(name).begin_list();
    for (const ViewerLayer& layer : layers)
        json.begin_object().add("number", layer.number).add("data", base64_of(layer.deflated)).end_object();
    json.end_list();
}

void add_worst(JsonWriter& json, const std::vector<ViewerPlace>& worst) {
    json.line().key("worst").begin_list();
    for (const ViewerPlace& place : worst) {
        json.begin_object().add("at_mm", place.at_mm).add("normal", place.normal).add("seen", place.seen);
        json.add("target", place.target).add("print", place.print);
        json.add("cause", place.cause).add("span_mm", place.span_mm).end_object();
    }
    json.end_list();
}

}  // namespace

std::string viewer_json(const ReportViewer& viewer, std::span<const ViewerResin> resins, std::string_view about) {
    JsonWriter json;
    json.begin_object().add("heading", viewer.heading).add("viewing_distance_mm", viewer.viewing_distance_mm);
    json.add("about", about).add("cut", viewer.voxels.has_value());
    json.line().key("resins").begin_list();
    for (const ViewerResin& resin : resins)
        json.begin_object().add("name", resin.name).add("role", resin.role).add("rgb", resin.rgb).end_object();
    json.end_list();
    if (viewer.surface) add_surface(json, *viewer.surface);
    add_worst(json, viewer.worst);
    json.end_object();
    return json.text();
}

std::string voxels_json(const ViewerVoxels& v) {
    JsonWriter json;
    json.begin_object();
    json.add("size", v.size).add("pitch_mm", v.pitch_mm).add("step", v.step).add("layer_file", v.layer_file);
    add_layers(json, "layers", v.layers);
    add_layers(json, "whole", v.whole);
    json.end_object();
    return json.text();
}

std::size_t packed_bytes(const ViewerSurface& surface) {
    JsonWriter json;
    json.begin_object();
    add_surface(json, surface);
    return json.text().size();
}

std::size_t packed_bytes(const std::vector<ViewerLayer>& layers) {
    std::size_t bytes = 0;
    for (const ViewerLayer& layer : layers) bytes += (layer.deflated.size() + 2) / 3 * 4 + 40;
    return bytes;
}

std::size_t packed_bytes(const ViewerVoxels& voxels) {
    return packed_bytes(voxels.layers) + packed_bytes(voxels.whole);
}

}  // namespace voxtone::io

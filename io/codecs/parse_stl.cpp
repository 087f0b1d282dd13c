// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/parse_stl.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "base/error.h"
#include "base/warning.h"
#include "io/codecs/polygon_triangles.h"
#include "io/models/model_text.h"

namespace voxtone::io {

namespace {

constexpr std::size_t stl_header_bytes = 84, facet_bytes = 50;  // of a binary file, with the count

std::string_view chars(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::uint32_t declared_facets(std::span<const std::byte> bytes) {
    std::uint32_t count = 0;
    if (bytes.size() >= stl_header_bytes) std::memcpy(&count, bytes.data() + stl_header_bytes - 4, 4);
    return count;
}

void note_colours(std::span<const std::byte> bytes, std::uint32_t count, const std::string& name, ModelParts& parts) {
    constexpr std::uint32_t none = 0x10000;
    std::uint32_t coloured = 0, plain = 0, first = none;
    bool differ = false;
    for (std::uint32_t i = 0; i < count; ++i) {
        std::uint16_t word = 0;
        std::memcpy(&word, bytes.data() + stl_header_bytes + i * facet_bytes + facet_bytes - 2, 2);
        if (word == 0) continue;
        ++(word & 0x8000 ? coloured : plain);
        if (first == none) first = word;
        differ |= word != first;
    }
    const bool by_magics = chars(bytes).substr(0, 80).find("COLOR=") != std::string_view::npos;
    if (by_magics || (coloured && !plain && (differ || coloured < count)))
        parts.lose_colour(fmt::format(
            "{} seems to hold facet colours ({} style); STL has no standard for them and they are LOST. Export the "
            "model as 3MF, OBJ, PLY or GLB to keep its colours.",
            name, by_magics ? "Magics" : "VisCAM"));
}

void add_facet(const std::vector<Eigen::Vector3d>& corners, const std::string& name, ModelParts& parts) {
    const auto first = static_cast<std::uint32_t>(parts.positions.size());
    parts.positions.insert(parts.positions.end(), corners.begin(), corners.end());
    for (const auto& triangle : polygon_triangles(corners, name))
        parts.add_triangle({first + triangle[0], first + triangle[1], first + triangle[2]}, 0);
}

void read_binary(std::span<const std::byte> bytes, std::uint32_t count, ModelParts& parts) {
    std::vector<Eigen::Vector3d> corners(3);
    for (std::uint32_t i = 0; i < count; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            Eigen::Vector3f corner;
            std::memcpy(corner.data(), bytes.data() + stl_header_bytes + i * facet_bytes + 12 * (c + 1), 12);
            corners[c] = corner.cast<double>();
        }
        add_facet(corners, {}, parts);
    }
}

/// Words alone matter: `vertex` and three numbers, `endloop` or `endfacet` behind the last of a facet.
void read_text(std::string_view text, const std::string& name, ModelParts& parts) {
    std::vector<Eigen::Vector3d> corners;
    bool comma = false;
    std::size_t too_few = 0;
    const auto finish = [&] {
        if (corners.size() >= 3)
            add_facet(corners, name, parts);
        else
            too_few += corners.empty() ? 0 : 1;
        corners.clear();
    };
    TextLines lines(text, false);
    while (const auto line = lines.next()) {
        std::string_view words = *line;
        while (!words.empty()) {
            const std::string word = lower_case(cut_word(words));
            if (word == "facet" || word == "endloop" || word == "endfacet") finish();
            // Behind these stands a name, which may hold any other.
            if (word == "solid" || word == "endsolid") break;
            if (word != "vertex") continue;
            Eigen::Vector3d& corner = corners.emplace_back();
            for (Eigen::Index i = 0; i < 3; ++i) {
                if (words.empty())
                    throw InputError(
                        fmt::format("{}, line {}: a vertex has fewer than three numbers; the file is "
                                    "damaged or cut short, export it again",
                                    name, lines.number()));
                corner[i] = number_of(cut_word(words), comma).value_or(std::numeric_limits<double>::quiet_NaN());
            }
        }
    }
    if (!corners.empty())
        throw InputError(
            fmt::format("{} ends in the middle of a facet: it is damaged or cut short, export it again", name));
    if (comma)
        parts.warnings.push_back(
            named_warning("decimal-commas", fmt::format("{} has decimal commas; they were read as points.", name)));
    if (too_few)
        parts.warnings.push_back(named_warning(
            "no-volume",
            fmt::format("{} has {} facets with fewer than three corners; they are left aside.", name, too_few)));
}

bool is_text(std::string_view text) {
    constexpr std::size_t looked_at = 4096;
    const std::string head = lower_case(trimmed(text.substr(0, looked_at)));
    return head.starts_with("solid") || head.find("facet normal") != std::string::npos;
}

/// Who writes facets as they come may never go back to tell how many there are.
constexpr bool is_left_open(std::uint32_t declared) { return declared == 0 || declared == 0xFFFFFFFF; }

/// Facets to read: as many as there are where their number was left open. Throws InputError where some are missing.
std::uint32_t facets_to_read(std::span<const std::byte> bytes, std::uint32_t declared, const std::string& name,
                             ModelParts& parts) {
    const std::uint64_t length = stl_header_bytes + std::uint64_t{declared} * facet_bytes,
                        behind = bytes.size() - std::min<std::uint64_t>(bytes.size(), stl_header_bytes),
                        there = behind / facet_bytes;
    const auto damaged = [&](const char* what) {
        parts.warnings.push_back(named_warning(
            "damaged", fmt::format("{} declares {} triangles and has bytes for {}: {}", name, declared, there, what)));
    };
    if (is_left_open(declared) && there > 0 && behind % facet_bytes == 0 && there < 0xFFFFFFFF) {
        damaged("all were read.");
        return static_cast<std::uint32_t>(there);
    }
    if (bytes.size() < stl_header_bytes || length > bytes.size())
        throw InputError(fmt::format(
            "{} is no STL file, or it is cut short: it declares {} triangles, which need {} bytes, and has {}", name,
            declared, length, bytes.size()));
    if (there > declared) damaged("what is behind them was left aside. Export it again.");
    return declared;
}

}  // namespace

ModelParts parse_stl(ParseContext& context) {
    ModelParts parts;
    parts.format = "STL";
    const std::span<const std::byte> bytes = context.bytes();
    const std::uint32_t count = declared_facets(bytes);
    const std::uint64_t length = stl_header_bytes + std::uint64_t{count} * facet_bytes;
    const bool exact = bytes.size() >= stl_header_bytes && length == bytes.size() && count > 0;
    if (!exact) {
        const std::string text = model_text(bytes);
        if (is_text(text) && lower_case(text).find("facet") != std::string::npos) {
            read_text(text, context.name(), parts);
            return parts;
        }
        if (is_text(text) && lower_case(text).find("endsolid") != std::string::npos)
            throw InputError(
                fmt::format("{} is an STL file without any facet, so there is nothing to print; check what "
                            "was chosen to be exported",
                            context.name()));
    }
    const std::uint32_t facets = facets_to_read(bytes, count, context.name(), parts);
    note_colours(bytes, facets, context.name(), parts);
    read_binary(bytes, facets, parts);
    return parts;
}

}  // namespace voxtone::io

// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/ply_header.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <sstream>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/printable.h"
#include "io/models/model_text.h"

namespace voxtone::io {

namespace {

PlyType type_of(const std::string& word, const std::string& name) {
    static constexpr std::pair<std::string_view, PlyType> types[] = {
        {"char", PlyType::int8},      {"int8", PlyType::int8},       {"uchar", PlyType::uint8},
        {"uint8", PlyType::uint8},    {"short", PlyType::int16},     {"int16", PlyType::int16},
        {"ushort", PlyType::uint16},  {"uint16", PlyType::uint16},   {"int", PlyType::int32},
        {"int32", PlyType::int32},    {"uint", PlyType::uint32},     {"uint32", PlyType::uint32},
        {"float", PlyType::float32},  {"float32", PlyType::float32}, {"double", PlyType::float64},
        {"float64", PlyType::float64}};
    for (const auto& [known, type] : types)
        if (word == known) return type;
    throw InputError(
        fmt::format("{}: the header has a property of the unknown type '{}'; export it again", name, word));
}

/// A property by its words after "property".
PlyProperty property_of(std::istringstream& words, const std::string& type, const std::string& name) {
    PlyProperty property;
    if (type == "list") {
        std::string count, item;
        words >> count >> item;
        property.is_list = true;
        property.count_type = type_of(count, name);
        property.type = type_of(item, name);
    } else {
        property.type = type_of(type, name);
    }
    words >> property.name;
    return property;
}

/// Of one item, with empty lists.
std::uint64_t least_bytes(const PlyElement& element, bool ascii) {
    if (ascii) return 2 * element.properties.size();  // a digit and a blank each
    std::uint64_t bytes = 0;
    for (const PlyProperty& p : element.properties) bytes += bytes_of(p.is_list ? p.count_type : p.type);
    return bytes;
}

/// Where the line "end_header" begins: not a comment or a longer word, behind which a parser would read on.
std::size_t end_of_header(std::string_view text) {
    constexpr std::string_view last = "end_header";
    for (std::size_t at = text.find(last); at != std::string_view::npos; at = text.find(last, at + 1)) {
        const std::size_t behind = at + last.size();
        const bool begins = at > 0 && (text[at - 1] == '\n' || text[at - 1] == '\r');
        if (begins &&
            (behind == text.size() || std::string_view(" \t\r\n").find(text[behind]) != std::string_view::npos))
            return at;
    }
    return std::string_view::npos;
}

/// Behind the end of the line that begins at `from`; lines end as the first one of the header does.
std::size_t end_of_line(std::string_view text, std::size_t from) {
    const std::size_t first = std::min(text.find_first_of("\r\n"), text.size());
    const bool returns_alone = first + 1 < text.size() && text[first] == '\r' && text[first + 1] != '\n';
    const std::size_t end = text.find(returns_alone ? '\r' : '\n', from);
    return end == std::string_view::npos ? text.size() : end + 1;
}

constexpr std::string_view colour_names[][4] = {{"red", "green", "blue", "alpha"},
                                                {"r", "g", "b", "a"},
                                                {"diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"},
                                                {"vertex_red", "vertex_green", "vertex_blue", "vertex_alpha"},
                                                {"ambient_red", "ambient_green", "ambient_blue", "ambient_alpha"}};

std::ptrdiff_t find_value(const PlyElement& element, std::string_view name) {
    const auto found = std::ranges::find_if(
        element.properties, [&](const PlyProperty& p) { return !p.is_list && lower_case(p.name) == name; });
    return found == element.properties.end() ? -1 : found - element.properties.begin();
}

/// But for colours.
PlyRole role_of(const PlyProperty& property) {
    static constexpr std::pair<std::string_view, PlyRole> values[] = {{"x", PlyRole::x},
                                                                      {"y", PlyRole::y},
                                                                      {"z", PlyRole::z},
                                                                      {"s", PlyRole::u},
                                                                      {"u", PlyRole::u},
                                                                      {"texture_u", PlyRole::u},
                                                                      {"texture_s", PlyRole::u},
                                                                      {"tx", PlyRole::u},
                                                                      {"t", PlyRole::v},
                                                                      {"v", PlyRole::v},
                                                                      {"texture_v", PlyRole::v},
                                                                      {"texture_t", PlyRole::v},
                                                                      {"ty", PlyRole::v},
                                                                      {"texnumber", PlyRole::page},
                                                                      {"material_index", PlyRole::material},
                                                                      {"material_indices", PlyRole::material}};
    static constexpr std::pair<std::string_view, PlyRole> lists[] = {{"vertex_indices", PlyRole::corners},
                                                                     {"vertex_index", PlyRole::corners},
                                                                     {"vertex_indexes", PlyRole::corners},
                                                                     {"texcoord", PlyRole::corner_uv}};
    const std::string name = lower_case(property.name);
    const std::span<const std::pair<std::string_view, PlyRole>> known =
        property.is_list ? std::span<const std::pair<std::string_view, PlyRole>>(lists) : values;
    for (const auto& [of_role, role] : known)
        if (name == of_role) return role;
    return PlyRole::none;
}

}  // namespace

std::vector<PlyRole> ply_roles(const PlyElement& element) {
    std::vector<PlyRole> roles;
    for (const PlyProperty& p : element.properties) roles.push_back(role_of(p));
    for (const auto& family : colour_names) {
        std::array<std::ptrdiff_t, 4> at{};
        for (std::size_t c = 0; c < 4; ++c) at[c] = find_value(element, family[c]);
        if (at[0] < 0 || at[1] < 0 || at[2] < 0) continue;
        if (at[3] < 0) at[3] = find_value(element, "alpha");
        for (std::size_t c = 0; c < 4; ++c)
            if (at[c] >= 0) roles[static_cast<std::size_t>(at[c])] = static_cast<PlyRole>(int(PlyRole::red) + int(c));
        break;
    }
    return roles;
}

bool ply_holds_splats(const PlyElement& element) {
    const auto has = [&](std::string_view name) {
        return std::ranges::any_of(element.properties, [&](const PlyProperty& p) { return p.name == name; });
    };
    return (has("scale_0") && has("rot_0")) || (has("f_dc_0") && (has("opacity") || has("scale_0"))) ||
           (has("packed_rotation") && has("packed_scale"));
}

std::string ply_unread_colour(const PlyElement& element) {
    if (std::ranges::count(ply_roles(element), PlyRole::red) > 0) return {};
    for (const PlyProperty& p : element.properties) {
        const std::string name = lower_case(p.name);
        if (name.find("red") != std::string::npos || name.find("colo") != std::string::npos || name == "rgb" ||
            name == "rgba")
            return p.name;
    }
    return {};
}

PlyHeader read_ply_header(std::span<const std::byte> bytes, const std::string& name) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()),
                                std::min<std::size_t>(bytes.size(), 1 << 20));
    const std::string_view mark = "\xEF\xBB\xBF";
    const std::size_t begin = text.starts_with(mark) ? mark.size() : 0, end = end_of_header(text);
    if (!text.substr(begin).starts_with("ply") || end == std::string_view::npos)
        throw InputError(fmt::format("{} is no PLY file or its header is cut short", name));
    PlyHeader header;
    header.bytes = end_of_line(text, end);
    TextLines lines(text.substr(begin, end - begin), false);
    while (const auto statement = lines.next()) {
        const std::string line(*statement);
        std::istringstream words(line);
        std::string key, second;
        words >> key >> second;
        if (key == "format") {
            header.encoding = second == "ascii"               ? PlyHeader::Encoding::ascii
                              : second == "binary_big_endian" ? PlyHeader::Encoding::big_endian
                                                              : PlyHeader::Encoding::little_endian;
        } else if (key == "comment" && lower_case(second) == "texturefile") {
            std::string file;
            std::getline(words >> std::ws, file);
            header.texture_files.emplace_back(trimmed(file));  // some leave blanks there
        } else if (key == "element") {
            PlyElement element{second, 0, {}};
            if (!(words >> element.count))
                throw InputError(fmt::format("{}: the line '{}' of the header has no number", name, line));
            header.elements.push_back(std::move(element));
        } else if (key == "property" && !header.elements.empty()) {
            PlyElement& element = header.elements.back();
            element.properties.push_back(property_of(words, second, name));
        } else if (!key.empty() && key != "ply" && key != "comment" && key != "obj_info") {
            throw InputError(fmt::format("{}: the header has the line '{}', which PLY does not know; export it again",
                                         name, printable(line)));
        }
    }
    std::uint64_t left = bytes.size() - end;
    for (const PlyElement& element : header.elements) {
        const std::uint64_t least = least_bytes(element, header.encoding == PlyHeader::Encoding::ascii);
        if (least == 0 && element.count > 0)
            throw InputError(fmt::format("{} declares {} items '{}' that hold nothing; it is damaged, export it again",
                                         name, element.count, element.name));
        if (least > 0 && element.count > left / least)
            throw InputError(
                fmt::format("{} declares {} items '{}', more than its {} bytes can hold; it is damaged or cut short",
                            name, element.count, element.name, bytes.size()));
        left -= element.count * least;
    }
    return header;
}

}  // namespace voxtone::io

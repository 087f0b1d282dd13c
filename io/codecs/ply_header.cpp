// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/codecs/ply_header.h"

#include <algorithm>
#include <cstdint>
#include <sstream>
#include <string_view>

#include <fmt/format.h>

#include "voxtone/base/error.h"

namespace voxtone::io {

namespace {

bool is_float(const std::string& type) {
    return type == "float" || type == "float32" || type == "double" || type == "float64";
}

std::uint64_t bytes_of(const std::string& type) {
    if (type == "double" || type == "float64") return 8;
    if (type == "int" || type == "int32" || type == "uint" || type == "uint32" || type == "float" || type == "float32")
        return 4;
    if (type == "short" || type == "int16" || type == "ushort" || type == "uint16") return 2;
    return 1;
}

struct Element {
    std::string name;
    std::uint64_t count = 0, min_bytes = 0, properties = 0;  // min_bytes: of one binary item, empty lists
};

}  // namespace

PlyHeader read_ply_header(std::span<const std::byte> bytes, const std::string& name) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()),
                                std::min<std::size_t>(bytes.size(), 1 << 20));
    const std::size_t end = text.find("end_header");
    if (!text.starts_with("ply") || end == std::string_view::npos)
        throw InputError(fmt::format("{} is no PLY file or its header is cut short", name));
    std::istringstream lines{std::string(text.substr(0, end))};
    PlyHeader header;
    std::vector<Element> elements;
    bool ascii = false;
    for (std::string line; std::getline(lines, line);) {
        if (!line.empty() && line.back() == '\r') line.pop_back();
        std::istringstream words(line);
        std::string key, second, third;
        words >> key >> second;
        if (key == "format") ascii = second == "ascii";
        if (key == "comment" && second == "TextureFile") {
            std::getline(words >> std::ws, header.texture_file);
        } else if (key == "element") {
            Element element{second};
            if (!(words >> element.count))
                throw InputError(fmt::format("{}: the line '{}' of the header has no number", name, line));
            elements.push_back(element);
        } else if (key == "property" && !elements.empty()) {
            Element& element = elements.back();
            ++element.properties;
            if (second == "list") {
                words >> third;
                element.min_bytes += bytes_of(third);
                continue;
            }
            element.min_bytes += bytes_of(second);
            words >> third;
            if (third == "red" || third == "diffuse_red" || third == "r") {
                if (element.name == "vertex") header.integer_colours = !is_float(second);
                if (element.name == "face") header.face_colours = true;
            }
        }
    }
    std::uint64_t left = bytes.size() - end;
    for (const Element& element : elements) {
        const std::uint64_t least = ascii ? 2 * element.properties : element.min_bytes;  // a digit and a blank
        if (least == 0) continue;
        if (element.count > left / least)
            throw InputError(
                fmt::format("{} declares {} items '{}', more than its {} bytes can hold; it is damaged or cut short",
                            name, element.count, element.name, bytes.size()));
        left -= element.count * least;
    }
    return header;
}

}  // namespace voxtone::io

// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/codecs/mtl_library.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace voxtone::io {

namespace {

constexpr std::string_view blanks = " \t\r";

std::string_view trim(std::string_view text) {
    const std::size_t first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// Cuts the first word off the text.
std::string_view next_word(std::string_view& text) {
    text = trim(text);
    const std::size_t end = std::min(text.find_first_of(blanks), text.size());
    const std::string_view word = text.substr(0, end);
    text = trim(text.substr(end));
    return word;
}

std::optional<float> number(std::string_view word) {
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    float value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

/// Cuts up to three numbers off the text.
std::vector<float> numbers(std::string_view& text) {
    std::vector<float> values;
    while (values.size() < 3) {
        std::string_view rest = text;
        const std::optional<float> value = number(next_word(rest));
        if (!value) break;
        values.push_back(*value);
        text = rest;
    }
    return values;
}

/// Options before the file name, which may contain blanks.
void parse_map(std::string_view text, MtlMaterial& material) {
    while (!text.empty() && text.front() == '-') {
        std::string_view rest = text;
        const std::string_view option = next_word(rest);
        if (option == "-o" || option == "-s") {
            const std::vector<float> values = numbers(rest);
            Eigen::Vector2f& target = option == "-o" ? material.map_offset : material.map_scale;
            if (!values.empty()) target.x() = values[0];
            if (values.size() > 1) target.y() = values[1];
        } else if (option == "-t" || option == "-mm") {
            numbers(rest);
        } else if (option == "-clamp") {
            material.map_clamp = next_word(rest) == "on";
        } else if (option == "-blendu" || option == "-blendv" || option == "-cc" || option == "-imfchan" ||
                   option == "-boost" || option == "-texres" || option == "-bm" || option == "-type" ||
                   option == "-colorspace") {
            next_word(rest);
        } else {
            break;  // a file name that begins with a dash
        }
        text = rest;
    }
    if (text.size() > 1 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
    material.map_kd = text;
}

std::string lower(std::string_view text) {
    std::string out(text);
    std::transform(out.begin(), out.end(), out.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    return out;
}

}  // namespace

std::vector<MtlMaterial> parse_mtl(std::string_view text) {
    std::vector<MtlMaterial> materials;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = trim(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
        const std::string key = lower(next_word(line));
        if (key == "newmtl") {
            materials.emplace_back().name = line;
            continue;
        }
        if (materials.empty()) continue;
        MtlMaterial& material = materials.back();
        if (key == "kd") {
            const std::vector<float> values = numbers(line);
            if (values.size() == 1) material.kd = Eigen::Vector3f::Constant(values[0]).cwiseMax(0).cwiseMin(1);
            if (values.size() == 3)
                material.kd = Eigen::Vector3f(values[0], values[1], values[2]).cwiseMax(0).cwiseMin(1);
        } else if (key == "d" || key == "tr") {
            if (line.starts_with("-halo")) next_word(line);
            const std::vector<float> values = numbers(line);
            // Tr has no standard (MeshLab writes 1 for opaque, others 0): where d is there too, d counts.
            if (values.empty() || (key == "tr" && material.has_dissolve)) continue;
            material.has_dissolve |= key == "d";
            material.opacity = std::clamp(key == "d" ? values[0] : 1 - values[0], 0.0f, 1.0f);
        } else if (key == "map_kd") {
            parse_map(line, material);
        } else if (key == "map_d") {
            material.has_opacity_map = true;
        }
    }
    return materials;
}

}  // namespace voxtone::io

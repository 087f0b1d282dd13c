// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/mtl_library.h"

#include <algorithm>
#include <cmath>

#include "io/models/colour_range.h"
#include "io/models/model_text.h"

namespace voxtone::io {

namespace {

std::optional<float> number(std::string_view word) {
    bool comma = false;
    const std::optional<double> value = number_of(word, comma);
    if (!value || !std::isfinite(*value)) return std::nullopt;
    return static_cast<float>(*value);
}

/// Cuts up to three numbers off the text.
std::vector<float> numbers(std::string_view& text) {
    std::vector<float> values;
    while (values.size() < 3) {
        std::string_view rest = text;
        const std::optional<float> value = number(cut_word(rest));
        if (!value) break;
        values.push_back(*value);
        text = rest;
    }
    return values;
}

/// What a library says of one material beside what is taken of it.
struct Unlit {
    std::optional<Eigen::Vector3f> ka, ke;
    std::string map_ka, map_ke;
};

/// In [0, 1].
std::optional<Eigen::Vector3f> colour_of(std::string_view text) {
    const std::vector<float> values = numbers(text);
    if (values.size() != 1 && values.size() != 3) return std::nullopt;
    Eigen::Vector3f rgb =
        values.size() == 1 ? Eigen::Vector3f::Constant(values[0]) : Eigen::Vector3f(values[0], values[1], values[2]);
    const bool whole = rgb == Eigen::Vector3f(rgb.array().floor());
    rgb /= static_cast<float>(colour_range(static_cast<double>(rgb.maxCoeff()), ColourNumbers::reals, whole));
    return rgb.cwiseMax(0).cwiseMin(1);
}

bool is_grey(const Eigen::Vector3f& rgb) { return rgb.maxCoeff() - rgb.minCoeff() < 0.01f; }

void take_unlit(const Unlit& unlit, MtlMaterial& material) {
    const bool grey = !material.kd || is_grey(*material.kd), black = !material.kd || material.kd->maxCoeff() <= 0;
    if (material.map_kd.empty() && grey) {
        if (black && !unlit.map_ke.empty())
            material.map_kd = unlit.map_ke, material.map_from = "map_Ke";
        else if (!unlit.map_ka.empty())
            material.map_kd = unlit.map_ka, material.map_from = "map_Ka";
    }
    if (!black || !material.map_kd.empty()) return;
    if (unlit.ke && unlit.ke->maxCoeff() > 0)
        material.kd = unlit.ke, material.colour_from = "Ke";
    else if (unlit.ka && !is_grey(*unlit.ka))
        material.kd = unlit.ka, material.colour_from = "Ka";
}

/// A file name, which may contain blanks, behind options, which `material` gets.
std::string parse_map(std::string_view text, MtlMaterial& material) {
    while (!text.empty() && text.front() == '-') {
        std::string_view rest = text;
        const std::string_view option = cut_word(rest);
        if (option == "-o" || option == "-s") {
            const std::vector<float> values = numbers(rest);
            Eigen::Vector2f& target = option == "-o" ? material.map_offset : material.map_scale;
            if (!values.empty()) target.x() = values[0];
            if (values.size() > 1) target.y() = values[1];
        } else if (option == "-t" || option == "-mm") {
            (void)numbers(rest);
        } else if (option == "-clamp") {
            material.map_clamp = cut_word(rest) == "on";
        } else if (option == "-blendu" || option == "-blendv" || option == "-cc" || option == "-imfchan" ||
                   option == "-boost" || option == "-texres" || option == "-bm" || option == "-type" ||
                   option == "-colorspace") {
            (void)cut_word(rest);
        } else {
            break;  // a file name that begins with a dash
        }
        text = rest;
    }
    if (text.size() > 1 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
    return std::string(text);
}

}  // namespace

std::vector<MtlMaterial> parse_mtl(std::string_view text) {
    std::vector<MtlMaterial> materials;
    Unlit unlit;
    const auto finish = [&] {
        if (!materials.empty()) take_unlit(unlit, materials.back());
        unlit = {};
    };
    TextLines lines(text);
    while (const auto statement = lines.next()) {
        std::string_view line = *statement;
        const std::string key = lower_case(cut_word(line));
        if (key == "newmtl") {
            finish();
            materials.emplace_back().name = line;
            continue;
        }
        if (materials.empty()) continue;
        MtlMaterial& material = materials.back();
        if (key == "kd") {
            if (const auto rgb = colour_of(line))
                material.kd = rgb;
            else
                material.unread_kd = line;
        } else if (key == "ka") {
            unlit.ka = colour_of(line);
        } else if (key == "ke") {
            unlit.ke = colour_of(line);
        } else if (key == "d" || key == "tr") {
            if (line.starts_with("-halo")) (void)cut_word(line);
            const std::vector<float> values = numbers(line);
            // Tr has no standard (MeshLab writes 1 for opaque, others 0): where d is there too, d counts.
            if (values.empty() || (key == "tr" && material.has_dissolve)) continue;
            material.has_dissolve |= key == "d";
            material.opacity = std::clamp(key == "d" ? values[0] : 1 - values[0], 0.0f, 1.0f);
        } else if (key == "map_kd") {
            material.map_kd = parse_map(line, material);
        } else if (key == "map_ka" || key == "map_ke") {
            MtlMaterial options = material;
            (key == "map_ka" ? unlit.map_ka : unlit.map_ke) = parse_map(line, options);
        } else if (key == "map_d") {
            material.has_opacity_map = true;
        }
    }
    finish();
    return materials;
}

}  // namespace voxtone::io

// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/mtl_library.h"

#include <algorithm>
#include <cmath>
#include <iterator>

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

/// Cuts up to so many numbers off the text.
std::vector<float> numbers(std::string_view& text, std::size_t most = 3) {
    std::vector<float> values;
    while (values.size() < most) {
        std::string_view rest = text;
        const std::optional<float> value = number(cut_word(rest));
        if (!value) break;
        values.push_back(*value);
        text = rest;
    }
    return values;
}

/// A picture, and how it is laid.
struct LaidMap {
    std::string file;
    Eigen::Vector2f offset = Eigen::Vector2f::Zero(), scale = Eigen::Vector2f::Ones();
    bool clamp = false;
    float base = 0, gain = 1;
};

void lay(const LaidMap& map, MtlMaterial& material) {
    material.map_kd = map.file;
    material.map_offset = map.offset;
    material.map_scale = map.scale;
    material.map_clamp = map.clamp;
    material.map_base = map.base;
    material.map_gain = map.gain;
}

/// What a library says of one material beside what is taken of it.
struct Unlit {
    std::optional<Eigen::Vector3f> ka, ke;
    LaidMap map_ka, map_ke;
};

/// Whether a statement map_... is known to hold no colours: those of MTL, of its PBR extension and their kin.
bool is_known_map(std::string_view key) {
    static constexpr std::string_view whole[] = {"map_ks", "map_ns",  "map_ni",  "map_tf", "map_tr",
                                                 "map_kn", "map_aat", "map_pr",  "map_pm", "map_ps",
                                                 "map_pc", "map_pcr", "map_ao",  "map_d",  "map_kd",
                                                 "map_ka", "map_ke",  "map_orm", "map_rma"},
                                      parts[] = {"bump", "norm", "rough", "metal", "gloss", "spec",  "occl", "opac",
                                                 "alph", "heig", "disp",  "refl",  "sheen", "aniso", "trans"};
    const auto is_part = [&](std::string_view part) { return key.find(part) != key.npos; };
    return std::ranges::find(whole, key) != std::end(whole) || std::ranges::any_of(parts, is_part);
}

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
        if (black && !unlit.map_ke.file.empty())
            lay(unlit.map_ke, material), material.map_from = "map_Ke";
        else if (!unlit.map_ka.file.empty())
            lay(unlit.map_ka, material), material.map_from = "map_Ka";
    }
    if (!black || !material.map_kd.empty()) return;
    if (unlit.ke && unlit.ke->maxCoeff() > 0)
        material.kd = unlit.ke, material.colour_from = "Ke";
    else if (unlit.ka && !is_grey(*unlit.ka))
        material.kd = unlit.ka, material.colour_from = "Ka";
}

/// A file name, which may contain blanks, behind options.
LaidMap parse_map(std::string_view text) {
    LaidMap map;
    while (!text.empty() && text.front() == '-') {
        std::string_view rest = text;
        const std::string_view option = cut_word(rest);
        if (option == "-o" || option == "-s") {
            const std::vector<float> values = numbers(rest);
            Eigen::Vector2f& target = option == "-o" ? map.offset : map.scale;
            if (!values.empty()) target.x() = values[0];
            if (values.size() > 1) target.y() = values[1];
        } else if (option == "-mm") {
            const std::vector<float> values = numbers(rest, 2);
            if (!values.empty()) map.base = values[0];
            if (values.size() > 1) map.gain = values[1];
        } else if (option == "-t") {
            (void)numbers(rest);
        } else if (option == "-clamp") {
            map.clamp = cut_word(rest) == "on";
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
    map.file = text;
    return map;
}

}  // namespace

bool look_alike(const MtlMaterial& a, const MtlMaterial& b) {
    return a.kd == b.kd && a.is_linear == b.is_linear && a.unread_kd == b.unread_kd && a.opacity == b.opacity &&
           a.map_kd == b.map_kd && a.map_offset == b.map_offset && a.map_scale == b.map_scale &&
           a.map_clamp == b.map_clamp && a.map_base == b.map_base && a.map_gain == b.map_gain;
}

std::vector<MtlMaterial> parse_mtl(std::string_view text) {
    std::vector<MtlMaterial> materials;
    const bool by_blender = text.starts_with("# Blender ");
    Unlit unlit;
    const auto finish = [&] {
        if (!materials.empty()) take_unlit(unlit, materials.back());
        unlit = {};
    };
    TextLines lines(text);
    while (const auto statement = lines.next()) {
        std::string_view line = *statement;
        const std::string_view written = cut_word(line);
        const std::string key = lower_case(written);
        if (key == "newmtl") {
            finish();
            materials.emplace_back().name = line;
            materials.back().is_linear = by_blender;
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
            lay(parse_map(line), material);
        } else if (key == "map_ka" || key == "map_ke") {
            (key == "map_ka" ? unlit.map_ka : unlit.map_ke) = parse_map(line);
        } else if (key == "map_d") {
            material.has_opacity_map = true;
        } else if (key.starts_with("map_") && !is_known_map(key)) {
            material.unknown_maps.emplace_back(written, parse_map(line).file);
        }
    }
    finish();
    return materials;
}

}  // namespace voxtone::io

// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/layers/gcvf_config.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>

#include <fmt/core.h>

#include "voxtone/base/error.h"

namespace voxtone::io {
namespace {

std::string escaped(std::string_view text) {
    std::string result;
    for (const char c : text) switch (c) {
            case '&':
                result += "&amp;";
                break;
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '"':
                result += "&quot;";
                break;
            case '\'':
                result += "&apos;";
                break;
            default:
                result += c;
        }
    return result;
}

std::string unescaped(std::string_view text) {
    constexpr std::array<std::pair<std::string_view, char>, 5> entities = {
        {{"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}}};
    std::string result;
    while (!text.empty()) {
        bool found = false;
        for (const auto& [entity, c] : entities)
            if (text.starts_with(entity)) {
                result += c;
                text.remove_prefix(entity.size());
                found = true;
                break;
            }
        if (!found) {
            result += text.front();
            text.remove_prefix(1);
        }
    }
    return result;
}

/// Text between <tag> or <tag attributes> and the next </tag>, from `at` on; moves `at` behind it.
std::optional<std::string_view> element(std::string_view xml, std::string_view tag, std::size_t& at) {
    while ((at = xml.find('<', at)) != std::string_view::npos) {
        const std::string_view rest = xml.substr(at + 1);
        if (rest.starts_with(tag) && rest.size() > tag.size() &&
            (rest[tag.size()] == '>' || std::isspace(static_cast<unsigned char>(rest[tag.size()])))) {
            const std::size_t open = xml.find('>', at);
            if (open == std::string_view::npos) return std::nullopt;
            const std::size_t close = xml.find(fmt::format("</{}>", tag), open);
            if (close == std::string_view::npos) return std::nullopt;
            at = close;
            return xml.substr(open + 1, close - open - 1);
        }
        ++at;
    }
    return std::nullopt;
}

class Reader {
public:
    Reader(std::string_view xml, const std::string& source) : xml_(xml), source_(source) {}

    [[noreturn]] void fail(std::string_view tag, const std::string& rule) const {
        throw InputError(fmt::format("{}: element <{}>: {}", source_, tag, rule));
    }
    [[nodiscard]] std::string_view inner(std::string_view tag) const {
        std::size_t at = 0;
        const auto found = element(xml_, tag, at);
        if (!found) fail(tag, "is missing");
        return *found;
    }
    [[nodiscard]] std::string text(std::string_view tag) const {
        std::string_view t = inner(tag);
        while (!t.empty() && std::isspace(static_cast<unsigned char>(t.front()))) t.remove_prefix(1);
        while (!t.empty() && std::isspace(static_cast<unsigned char>(t.back()))) t.remove_suffix(1);
        return unescaped(t);
    }
    [[nodiscard]] std::uint64_t integer(std::string_view tag, std::uint64_t least, std::uint64_t most) const {
        const std::string t = text(tag);
        std::uint64_t value = 0;
        const auto [end, error] = std::from_chars(t.data(), t.data() + t.size(), value);
        if (error != std::errc() || end != t.data() + t.size() || value < least || value > most)
            fail(tag, fmt::format("holds \"{}\", expected a whole number from {} to {}", t.substr(0, 40), least, most));
        return value;
    }
    [[nodiscard]] double number(std::string_view tag, double least, double most) const {
        const std::string t = text(tag);
        double value = 0;
        const auto [end, error] = std::from_chars(t.data(), t.data() + t.size(), value);
        if (error != std::errc() || end != t.data() + t.size() || !(value >= least && value <= most))
            fail(tag, fmt::format("holds \"{}\", expected a number from {} to {}", t.substr(0, 40), least, most));
        return value;
    }
    [[nodiscard]] std::array<std::uint8_t, 4> rgba(std::string_view tag) const {
        const std::string t = text(tag);
        std::istringstream in(t);
        std::array<std::uint8_t, 4> result{};
        for (auto& value : result) {
            int v = -1;
            if (!(in >> v) || v < 0 || v > 255)
                fail(tag, fmt::format("holds \"{}\", expected four numbers from 0 to 255", t.substr(0, 40)));
            value = static_cast<std::uint8_t>(v);
        }
        return result;
    }

private:
    std::string_view xml_;
    const std::string& source_;
};

}  // namespace

std::string gcvf_material_name(const StackResin& resin) {
    if (resin.role == "C") return "VeroCY-V";
    if (resin.role == "M") return "VeroMGT-V";
    if (resin.role == "Y") return "VeroYL-V";
    if (resin.role == "K") return "VeroBlack";
    if (resin.role == "W") return "VeroPureWht";
    if (resin.role == "T") return "UltraClear";
    return resin.name;
}

GcvfConfig gcvf_config(const StackDescription& stack) {
    GcvfConfig config;
    // Whole dots per inch where the pitch means them (42.333 um is 600 dpi rounded to a nanometre).
    auto dpi = [](double pitch_um) {
        const double exact = 25400.0 / pitch_um;
        return std::abs(exact - std::round(exact)) < 1e-4 * exact ? std::round(exact) : exact;
    };
    config.x_dpi = dpi(stack.pitch_um[0]);
    config.y_dpi = dpi(stack.pitch_um[1]);
    config.slice_thickness_nm = static_cast<std::uint64_t>(std::llround(stack.pitch_um[2] * 1000));
    config.width_px = stack.size_px[0];
    config.height_px = stack.size_px[1];
    config.slices = stack.layers;
    const auto [r, g, b] = stack.background_rgb;
    config.background = {r, g, b, 255};
    for (const auto& resin : stack.resins)
        config.materials.push_back(
            {gcvf_material_name(resin), {resin.rgb[0], resin.rgb[1], resin.rgb[2], 255}, resin.voxels});
    return config;
}

std::string gcvf_config_text(const GcvfConfig& config) {
    auto rgba = [](const std::array<std::uint8_t, 4>& c) { return fmt::format("{} {} {} {}", c[0], c[1], c[2], c[3]); };
    std::string materials;
    for (const auto& material : config.materials)
        materials += fmt::format(
            "    <Material>\n      <Name>{}</Name>\n      <RGBA>{}</RGBA>\n      <VoxelCount>{}</VoxelCount>\n    "
            "</Material>\n",
            escaped(material.name), rgba(material.rgba), material.voxels);
    return fmt::format(
        "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<GCVF>\n  <Version>2</Version>\n"
        "  <Resolution>\n    <XDpi>{}</XDpi>\n    <YDpi>{}</YDpi>\n    "
        "<SliceThicknessNanoMeter>{}</SliceThicknessNanoMeter>\n  </Resolution>\n"
        "  <SliceDimensions>\n    <SliceWidth>{}</SliceWidth>\n    <SliceHeight>{}</SliceHeight>\n  "
        "</SliceDimensions>\n"
        "  <SliceRange>\n    <StartIndex>{}</StartIndex>\n    <NumberOfSlices>{}</NumberOfSlices>\n  </SliceRange>\n"
        "  <BitDepth>4</BitDepth>\n  <MaxNumberOfColors>6</MaxNumberOfColors>\n  "
        "<DataSemantics>Materials</DataSemantics>\n"
        "  <CreationMode>MODEL_ONLY</CreationMode>\n  <ImageFilePrefix>{}</ImageFilePrefix>\n"
        "  <MaterialList>\n    <BackGroundMaterialRGBA>{}</BackGroundMaterialRGBA>\n{}  </MaterialList>\n</GCVF>\n",
        config.x_dpi, config.y_dpi, config.slice_thickness_nm, config.width_px, config.height_px, config.start_index,
        config.slices, escaped(config.prefix), rgba(config.background), materials);
}

GcvfConfig parse_gcvf_config(std::string_view xml, const std::string& source) {
    const Reader root(Reader(xml, source).inner("GCVF"), source);
    GcvfConfig config;
    config.x_dpi = root.number("XDpi", 0.1, 1e6);
    config.y_dpi = root.number("YDpi", 0.1, 1e6);
    config.slice_thickness_nm = root.integer("SliceThicknessNanoMeter", 1, 100'000'000);
    config.width_px = static_cast<std::uint32_t>(root.integer("SliceWidth", 1, 65535));
    config.height_px = static_cast<std::uint32_t>(root.integer("SliceHeight", 1, 65535));
    config.start_index = static_cast<std::uint32_t>(root.integer("StartIndex", 0, 1'000'000));
    config.slices = static_cast<std::uint32_t>(root.integer("NumberOfSlices", 1, 1'000'000));
    config.prefix = root.text("ImageFilePrefix");
    if (config.prefix.size() > 64 || config.prefix.find_first_of("/\\") != std::string::npos)
        root.fail("ImageFilePrefix", "is too long or leads into another folder");
    const std::string_view list = root.inner("MaterialList");
    config.background = Reader(list, source).rgba("BackGroundMaterialRGBA");
    std::size_t at = 0;
    while (const auto inner = element(list, "Material", at)) {
        if (config.materials.size() >= 255) root.fail("MaterialList", "has more than 255 materials");
        const Reader material(*inner, source);
        config.materials.push_back(
            {material.text("Name"), material.rgba("RGBA"), material.integer("VoxelCount", 0, std::uint64_t{1} << 62)});
    }
    return config;
}

}  // namespace voxtone::io

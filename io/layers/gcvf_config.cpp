// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/gcvf_config.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <sstream>

#include <fmt/core.h>

#include "base/error.h"
#include "io/disk/disk_space.h"
#include "io/files/markup.h"
#include "io/files/xml_reader.h"
#include "io/layers/topmost_layers.h"

namespace voxtone::io {
namespace {

/// Names of elements and the text in them.
using Elements = std::map<std::string, std::string, std::less<>>;

template <class Number>
std::optional<Number> number_in(const std::string& text) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

class ElementReader {
public:
    ElementReader(const Elements& elements, const std::string& source) : elements_(elements), source_(source) {}

    [[noreturn]] void fail(std::string_view tag, const std::string& rule) const {
        throw InputError(fmt::format("{}: element <{}>: {}", source_, tag, rule));
    }
    [[nodiscard]] const std::string& text(std::string_view tag) const {
        const auto found = elements_.find(tag);
        if (found == elements_.end()) fail(tag, "is missing");
        return found->second;
    }
    [[nodiscard]] std::string text_or_nothing(std::string_view tag) const {
        const auto found = elements_.find(tag);
        return found == elements_.end() ? std::string() : found->second;
    }
    [[nodiscard]] std::uint64_t integer(std::string_view tag, std::uint64_t least, std::uint64_t most) const {
        const auto value = number_in<std::uint64_t>(text(tag));
        if (!value || *value < least || *value > most)
            fail(tag, fmt::format("holds \"{}\", expected a whole number from {} to {}", text(tag).substr(0, 40), least,
                                  most));
        return *value;
    }
    [[nodiscard]] double number(std::string_view tag, double least, double most) const {
        const auto value = number_in<double>(text(tag));
        if (!value || !(*value >= least && *value <= most))
            fail(tag,
                 fmt::format("holds \"{}\", expected a number from {} to {}", text(tag).substr(0, 40), least, most));
        return *value;
    }
    [[nodiscard]] std::array<std::uint8_t, 4> rgba(std::string_view tag) const {
        std::istringstream in(text(tag));
        std::array<std::uint8_t, 4> result{};
        for (auto& value : result) {
            int v = -1;
            if (!(in >> v) || v < 0 || v > 255)
                fail(tag, fmt::format("holds \"{}\", expected four numbers from 0 to 255", text(tag).substr(0, 40)));
            value = static_cast<std::uint8_t>(v);
        }
        return result;
    }

private:
    const Elements& elements_;
    const std::string& source_;
};

std::string without_blanks_around(std::string_view text) {
    constexpr std::string_view blanks = " \t\r\n";
    const std::size_t first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) return {};
    return XmlReader::decode(text.substr(first, text.find_last_not_of(blanks) - first + 1));
}

struct GcvfElements {
    Elements all;                     ///< but those of materials; the first of each name
    std::vector<Elements> materials;  ///< of each <Material>
};

GcvfElements read_elements(std::string_view text, const std::string& source) {
    GcvfElements result;
    Elements* into = &result.all;
    XmlReader xml(text, source);
    for (XmlReader::Event event; (event = xml.next()) != XmlReader::Event::finished;) {
        const bool material = xml.name() == "Material" && xml.depth() > 1;
        if (event == XmlReader::Event::end) {
            if (material) into = &result.all;
        } else if (material) {
            if (result.materials.size() >= 255)
                ElementReader(result.all, source).fail("MaterialList", "has more than 255 materials");
            into = &result.materials.emplace_back();
        } else {
            into->emplace(xml.name(), without_blanks_around(xml.text()));
        }
    }
    return result;
}

/// The maker's names, of Vivid cartridges and of the opaque ones before them; of several for one role the first is
/// written.
struct MakersName {
    std::string_view role, name;
};
constexpr std::array<MakersName, 11> makers{{{"C", "VeroCY-V"},
                                             {"M", "VeroMGT-V"},
                                             {"Y", "VeroYL-V"},
                                             {"K", "VeroBlack"},
                                             {"W", "VeroPureWht"},
                                             {"W", "VUltraWhite"},
                                             {"T", "UltraClear"},
                                             {"C", "VeroCyan"},
                                             {"M", "VeroMgnt"},
                                             {"Y", "VeroYellow"},
                                             {"T", "VeroClear"}}};

/// What the resins of a set are called that its maker shortens in a GCVF.
constexpr std::array<std::pair<std::string_view, std::string_view>, 2> shortened{
    {{"VeroMagenta", "VeroMgnt"}, {"VeroWhite", "VeroPureWht"}}};

}  // namespace

std::string gcvf_material_name(const StackResin& resin) {
    if (!role_of_gcvf_material(resin.name).empty()) return resin.name;
    for (const auto& [full, written] : shortened)
        if (resin.name == full) return std::string(written);
    const auto named = std::find_if(makers.begin(), makers.end(), [&](const auto& m) { return m.role == resin.role; });
    return named != makers.end() ? std::string(named->name) : resin.name;
}

std::string_view role_of_gcvf_material(std::string_view name) {
    const auto named = std::find_if(makers.begin(), makers.end(), [&](const auto& m) { return m.name == name; });
    return named != makers.end() ? named->role : std::string_view();
}

void expect_gcvf(const StackDescription& stack) {
    if (stack.resins.size() > most_gcvf_colours)
        throw InputError(
            fmt::format("gcvf: {} resins are loaded, and a GCVF says itself that it holds {} at most "
                        "(MaxNumberOfColors): load fewer (--load), or leave gcvf out of --formats",
                        stack.resins.size(), most_gcvf_colours));
    if (stack.layers > TopmostLayers::most_layers)
        throw InputError(
            fmt::format("gcvf: {} layers, and a GCVF holds {} at most, as its Zbuffer.png counts them in 16 bits: make "
                        "it lower (--size, --rotate), print parts of it (--layers), or leave gcvf out of --formats",
                        stack.layers, TopmostLayers::most_layers));
}

std::string gcvf_size_note(std::uint64_t bytes, std::uint64_t entries) {
    constexpr std::uint64_t most_bytes = 0xffffffff, most_entries = 0xffff;  // where ZIP's own fields are full
    if (bytes < most_bytes && entries < most_entries) return {};
    return fmt::format(
        "the GCVF has {} in {} entries: beyond 4 GiB or 65,534 entries ZIP has a later form, ZIP64, and whether the "
        "printer's software reads that is not known; if it does not, give it the PNG layers (--formats png)",
        bytes_text(bytes), entries);
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
            markup_text(material.name), rgba(material.rgba), material.voxels);
    return fmt::format(
        "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<GCVF>\n  <Version>{}</Version>\n"
        "  <Resolution>\n    <XDpi>{}</XDpi>\n    <YDpi>{}</YDpi>\n    "
        "<SliceThicknessNanoMeter>{}</SliceThicknessNanoMeter>\n  </Resolution>\n"
        "  <SliceDimensions>\n    <SliceWidth>{}</SliceWidth>\n    <SliceHeight>{}</SliceHeight>\n  "
        "</SliceDimensions>\n"
        "  <SliceRange>\n    <StartIndex>{}</StartIndex>\n    <NumberOfSlices>{}</NumberOfSlices>\n  </SliceRange>\n"
        "  <BitDepth>{}</BitDepth>\n  <MaxNumberOfColors>{}</MaxNumberOfColors>\n  "
        "<DataSemantics>{}</DataSemantics>\n"
        "  <CreationMode>MODEL_ONLY</CreationMode>\n  <ImageFilePrefix>{}</ImageFilePrefix>\n"
        "  <MaterialList>\n    <BackGroundMaterialRGBA>{}</BackGroundMaterialRGBA>\n{}  </MaterialList>\n</GCVF>\n",
        markup_text(config.version), config.x_dpi, config.y_dpi, config.slice_thickness_nm, config.width_px,
        config.height_px, config.start_index, config.slices, markup_text(config.bit_depth),
        markup_text(config.most_colours), markup_text(config.semantics), markup_text(config.prefix),
        rgba(config.background), materials);
}

GcvfConfig parse_gcvf_config(std::string_view xml, const std::string& source) {
    const GcvfElements elements = read_elements(xml, source);
    const ElementReader root(elements.all, source);
    (void)root.text("GCVF");
    GcvfConfig config;
    config.version = root.text_or_nothing("Version");
    config.bit_depth = root.text_or_nothing("BitDepth");
    config.most_colours = root.text_or_nothing("MaxNumberOfColors");
    config.semantics = root.text_or_nothing("DataSemantics");
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
    config.background = root.rgba("BackGroundMaterialRGBA");
    for (const Elements& of_one : elements.materials) {
        const ElementReader material(of_one, source);
        config.materials.push_back(
            {material.text("Name"), material.rgba("RGBA"), material.integer("VoxelCount", 0, std::uint64_t{1} << 62)});
    }
    return config;
}

std::vector<std::string> unknown_in(const GcvfConfig& config) {
    std::vector<std::string> result;
    const GcvfConfig known;
    const auto compare = [&](std::string_view tag, const std::string& said, const std::string& wanted) {
        if (said.empty())
            result.push_back(fmt::format("does not say its {}, which is {} where it is known", tag, wanted));
        else if (said != wanted)
            result.push_back(fmt::format("{} {} is not known here, only {} is", tag, said.substr(0, 40), wanted));
    };
    compare("Version", config.version, known.version);
    compare("DataSemantics", config.semantics, known.semantics);
    compare("BitDepth", config.bit_depth, known.bit_depth);
    const auto most = number_in<std::uint64_t>(config.most_colours);
    if (!most)
        result.emplace_back("does not say how many resins it holds (MaxNumberOfColors)");
    else if (config.materials.size() > *most)
        result.push_back(fmt::format("names {} materials, and says that it holds {} (MaxNumberOfColors)",
                                     config.materials.size(), *most));
    return result;
}

}  // namespace voxtone::io

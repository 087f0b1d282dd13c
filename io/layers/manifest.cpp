// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/manifest.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "base/printable.h"
#include "io/files/json_object.h"
#include "io/files/json_writer.h"
#include "io/files/sha256.h"
#include "optics/media/lateral_spread.h"

namespace voxtone::io {
namespace {

constexpr double most_um = 1e5, most_mm = 1e6;
constexpr std::string_view seal_key = "manifest_sha256";

[[noreturn]] void broken(std::string_view source, std::string_view key, const std::string& rule) {
    throw InputError(fmt::format("{}: key `{}`: {}", source, key, rule));
}

/// "PREFIX%0Nd.png" in one folder at most, without any way out of it. The number of digits, or 0 where it is anything
/// else.
int pattern_digits(const std::string& pattern) {
    const std::size_t percent = pattern.find('%');
    if (percent == std::string::npos || pattern.size() != percent + 8 || pattern[percent + 1] != '0' ||
        pattern[percent + 2] < '1' || pattern[percent + 2] > '9' || pattern.substr(percent + 3) != "d.png")
        return 0;
    const std::string_view prefix(pattern.data(), percent);
    for (const char c : prefix)
        if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
              c == '/'))
            return 0;
    if (prefix.starts_with('/') || std::count(prefix.begin(), prefix.end(), '/') > 1) return 0;
    return pattern[percent + 2] - '0';
}

Rgb read_rgb(const JsonObject& object, std::string_view key) {
    const auto values = object.integers(key, 3, 0, 255);
    return {static_cast<std::uint8_t>(values[0]), static_cast<std::uint8_t>(values[1]),
            static_cast<std::uint8_t>(values[2])};
}

std::array<double, 3> read_three(const JsonObject& object, std::string_view key, double least, double most) {
    const auto values = object.numbers(key, 3, least, most);
    return {values[0], values[1], values[2]};
}

StackMember member_in(const JsonObject& json) {
    json.allow_only({"name", "boxes_mm", "ml", "verdict", "about"});
    StackMember member{json.text("name"), {}, json.number("ml", 0, 1e12), {}, {}};
    if (json.has("about")) member.about = json.text("about");
    for (const auto& list : json.number_lists("boxes_mm", 0, -most_mm, most_mm)) {
        if (list.size() != 6) json.fail("boxes_mm", "holds a box that is not of six numbers");
        std::copy(list.begin(), list.end(), member.boxes_mm.emplace_back().begin());
    }
    if (json.has("verdict")) member.verdict = json.text("verdict");
    return member;
}

StackDescription from_json(const JsonObject& json, std::string_view source) {
    json.allow_only({"format", "version", "printer", "pitch_um", "spread_mm", "size_px", "layers", "first_layer",
                     "size_mm", "origin_mm", "pattern", "background_rgb", "resins", "orientation", "resin_pixels",
                     "members", "content_sha256", seal_key});
    if (json.text("format") != "voxtone-layers")
        json.fail("format", "is not \"voxtone-layers\": this is no manifest of a layer stack");
    if (json.integer("version", 0, 1000000) != 1)
        json.fail("version", "is not 1, the only version this program knows; use a newer voxtone");
    StackDescription stack;
    stack.printer = json.text("printer");
    stack.pitch_um = read_three(json, "pitch_um", 0.001, most_um);
    if (json.has("spread_mm")) {
        const auto spread = json.numbers("spread_mm", 2, 0, optics::widest_spread_mm);
        stack.spread_mm = {spread[0], spread[1]};
    }
    const auto size = json.integers("size_px", 2, 1, 65535);
    stack.size_px = {static_cast<std::uint32_t>(size[0]), static_cast<std::uint32_t>(size[1])};
    stack.layers = static_cast<std::uint32_t>(json.integer("layers", 1, 1000000));
    if (json.has("first_layer"))
        stack.first_layer = static_cast<std::uint32_t>(json.integer("first_layer", 0, 1000000));
    stack.size_mm = read_three(json, "size_mm", 0, most_mm);
    stack.origin_mm = read_three(json, "origin_mm", -most_mm, most_mm);
    stack.pattern = json.text("pattern");
    stack.background_rgb = read_rgb(json, "background_rgb");
    for (const auto& entry : json.objects("resins")) {
        entry.allow_only({"name", "role", "rgb", "voxels", "ml"});
        stack.resins.push_back({entry.text("name"), entry.text("role"), read_rgb(entry, "rgb"),
                                entry.integer("voxels", 0, std::uint64_t{1} << 62), entry.number("ml", 0, 1e12)});
    }
    if (json.has("orientation")) {
        const auto orientation = json.object("orientation");
        orientation.allow_only({"flip_x", "flip_y", "swap_xy"});
        stack.orientation = {orientation.boolean("flip_x"), orientation.boolean("flip_y"),
                             orientation.boolean("swap_xy")};
    }
    if (json.has("resin_pixels")) {
        const auto pixels = value_of<ResinPixels>(json.text("resin_pixels"));
        if (!pixels) json.fail("resin_pixels", "is neither \"white\" nor \"black\"");
        stack.resin_pixels = *pixels;
    }
    if (json.has("members"))
        for (const auto& entry : json.objects("members")) stack.members.push_back(member_in(entry));
    stack.content_sha256 = json.text("content_sha256");
    stack.validate(source);
    return stack;
}

}  // namespace

std::vector<Rgb> StackDescription::palette() const {
    std::vector<Rgb> colours = {background_rgb};
    for (const auto& resin : resins) colours.push_back(resin.rgb);
    return colours;
}

std::string StackDescription::layer_path(std::uint32_t index) const {
    const std::size_t percent = pattern.find('%');
    std::string number = std::to_string(first_layer + index);
    const auto digits = static_cast<std::size_t>(pattern_digits(pattern));
    if (number.size() < digits) number.insert(0, digits - number.size(), '0');
    return pattern.substr(0, percent) + number + ".png";
}

void StackDescription::validate(std::string_view source) const {
    for (const double pitch : pitch_um)
        if (!(pitch >= 0.001 && pitch <= most_um))
            broken(source, "pitch_um", fmt::format("holds {}, expected numbers from 0.001 to {}", pitch, most_um));
    for (const auto px : size_px)
        if (px < 1 || px > 65535) broken(source, "size_px", fmt::format("holds {}, expected 1 to 65535", px));
    if (layers < 1) broken(source, "layers", "is 0, expected at least 1");
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (const double expected = stack_size_mm(*this)[axis];
            std::abs(size_mm[axis] - expected) > 0.01 + 1e-3 * expected)
            broken(source, "size_mm",
                   fmt::format("holds {:.3f} where size_px, layers and pitch_um give {:.3f} mm; one of them is wrong",
                               size_mm[axis], expected));
    const int digits = pattern_digits(pattern);
    if (digits == 0)
        broken(source, "pattern",
               fmt::format(
                   "is {}, expected something like \"layers/slice_%05d.png\" (letters, digits, _ and -, one folder)",
                   json_quoted(pattern)));
    if (std::uint64_t{first_layer} + layers > static_cast<std::uint64_t>(std::llround(std::pow(10.0, digits))))
        broken(source, "pattern", fmt::format("has {} digits, too few for layer {}", digits, first_layer + layers - 1));
    if (resins.empty() || resins.size() >= max_materials)
        broken(source, "resins", fmt::format("has {} entries, expected 1 to {}", resins.size(), max_materials - 1));
    for (std::size_t i = 0; i < resins.size(); ++i) {
        const auto name = fmt::format("resins[{}]", i);
        if (resins[i].name.empty() || resins[i].role.empty()) broken(source, name, "has an empty name or role");
        if (resins[i].rgb == background_rgb)
            broken(source, name + ".rgb",
                   fmt::format("is [{}], the background's colour, which is not printed: give this resin another colour",
                               fmt::join(resins[i].rgb, ", ")));
        if (!(resins[i].ml >= 0 && std::isfinite(resins[i].ml))) broken(source, name + ".ml", "is no number from 0 up");
        for (std::size_t j = 0; j < i; ++j) {
            if (resins[j].rgb == resins[i].rgb)
                broken(source, name + ".rgb",
                       fmt::format("is also the colour of resins[{}]: one colour means one resin", j));
            if (resins[j].role == resins[i].role)
                broken(source, name + ".role", fmt::format("is also the role of resins[{}]: roles are unique", j));
        }
    }
    for (std::size_t i = 0; i < members.size(); ++i) {
        const auto name = fmt::format("members[{}]", i);
        if (members[i].name.empty()) broken(source, name, "has an empty name");
        for (std::size_t j = 0; j < i; ++j)
            if (members[j].name == members[i].name)
                broken(source, name + ".name", fmt::format("is also that of members[{}]: names are unique", j));
        for (const auto& box : members[i].boxes_mm)
            for (std::size_t axis = 0; axis < 3; ++axis)
                if (!(box[axis] <= box[axis + 3]))
                    broken(source, name + ".boxes_mm", "holds a box that ends before it begins");
    }
    if (content_sha256.size() != 64 || content_sha256.find_first_not_of("0123456789abcdef") != std::string::npos)
        broken(source, "content_sha256", "is not 64 lower-case hexadecimal digits");
}

std::array<double, 3> stack_size_mm(const StackDescription& stack) {
    return {stack.size_px[0] * stack.pitch_um[0] * 1e-3, stack.size_px[1] * stack.pitch_um[1] * 1e-3,
            stack.layers * stack.pitch_um[2] * 1e-3};
}

double millilitres(std::uint64_t voxels, const std::array<double, 3>& pitch_um) {
    return static_cast<double>(voxels) * pitch_um[0] * pitch_um[1] * pitch_um[2] * 1e-12;  // 1 ml = 1e12 um^3
}

namespace {

void add_members(JsonWriter& json, const StackDescription& stack) {
    if (stack.members.empty()) return;
    json.line().key("members").begin_list();
    for (const StackMember& member : stack.members) {
        json.line().begin_object().add("name", member.name).key("boxes_mm").begin_list();
        for (const std::array<double, 6>& box : member.boxes_mm) json.value(box);
        json.end_list().add("ml", member.ml);
        if (!member.verdict.empty()) json.add("verdict", member.verdict);
        if (!member.about.empty()) json.add("about", member.about);
        json.end_object();
    }
    json.end_list();
}

void add_keys(JsonWriter& json, const StackDescription& stack) {
    json.add("format", "voxtone-layers").add("version", 1);
    json.line().add("printer", stack.printer).add("pitch_um", stack.pitch_um);
    if (stack.spread_mm != std::array<double, 2>{}) json.add("spread_mm", stack.spread_mm);
    json.line().add("size_px", stack.size_px).add("layers", stack.layers).add("first_layer", stack.first_layer);
    json.add("size_mm", stack.size_mm).add("origin_mm", stack.origin_mm);
    json.line().add("pattern", stack.pattern).add("background_rgb", stack.background_rgb);
    json.line().key("resins").begin_list();
    for (const StackResin& resin : stack.resins) {
        json.line().begin_object().add("name", resin.name).add("role", resin.role).add("rgb", resin.rgb);
        json.add("voxels", resin.voxels).add("ml", resin.ml).end_object();
    }
    json.end_list();
    json.line().key("orientation").begin_object().add("flip_x", stack.orientation.flip_x);
    json.add("flip_y", stack.orientation.flip_y).add("swap_xy", stack.orientation.swap_xy).end_object();
    if (stack.resin_pixels != ResinPixels::unsaid) json.line().add("resin_pixels", name_of(stack.resin_pixels));
    add_members(json, stack);
    json.line().add("content_sha256", stack.content_sha256);
}

/// With the digest of what it says, or without for that digest.
std::string text_of(const StackDescription& stack, const std::string& seal) {
    JsonWriter json;
    json.begin_object();
    add_keys(json, stack);
    if (!seal.empty()) json.line().add(seal_key, seal);
    json.end_object();
    return json.text() + "\n";
}

std::string seal_of(const StackDescription& stack) {
    const std::string text = text_of(stack, "");
    return sha256({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

}  // namespace

void add_stack(JsonWriter& json, const StackDescription& stack) {
    json.begin_object();
    add_keys(json, stack);
    json.end_object();
}

StackDescription stack_in(const JsonObject& json, std::string_view source) { return from_json(json, source); }

std::string manifest_text(const StackDescription& stack) {
    stack.validate("manifest");
    return text_of(stack, seal_of(stack));
}

StackDescription parse_manifest(std::string_view text, std::string source) {
    return from_json(JsonObject::parse(text, source), source);
}

StackDescription read_manifest(const std::filesystem::path& file) {
    return from_json(JsonObject::read(file), file.string());
}

namespace {

ManifestSeal seal_in(const JsonObject& json, std::string_view source) {
    if (!json.has(seal_key)) return ManifestSeal::none;
    return json.text(seal_key) == seal_of(from_json(json, source)) ? ManifestSeal::whole : ManifestSeal::broken;
}

}  // namespace

ManifestSeal seal_of_manifest(const std::filesystem::path& file) {
    return seal_in(JsonObject::read(file), file.string());
}

ManifestSeal seal_of_manifest_text(std::string_view text, std::string source) {
    return seal_in(JsonObject::parse(text, source), source);
}

}  // namespace voxtone::io

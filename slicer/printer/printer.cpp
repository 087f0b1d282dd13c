// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/printer/printer.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <set>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/embedded_file.h"
#include "base/error.h"
#include "base/warning.h"
#include "halftone/separation/mixture.h"
#include "io/files/json_keys.h"
#include "io/files/json_object.h"
#include "io/layers/layer_runs.h"
#include "optics/media/lateral_spread.h"

namespace voxtone::embedded {
std::span<const EmbeddedFile> printers();
}

namespace voxtone::slicer {

namespace {

constexpr double um_per_inch = 25400;
constexpr int most_colours = io::max_materials - 1;
/// No voxel of a material-jetting printer is near these limits; a figure beyond them is in the wrong unit.
constexpr double smallest_pitch_um = 1, largest_pitch_um = 1000;

const std::initializer_list<std::string_view> known_keys{
    "format",     "version",        "name",       "dpi",         "layer_um",        "pitch_um",       "tray_mm",
    "max_resins", "max_colours",    "formats",    "min_layers",  "colours",         "background_rgb", "default_roles",
    "flip_x",     "material_names", "flip_y",     "unconfirmed", "swap_xy",         "notes",          "default_resins",
    "utility",    "mode",           "cartridges", "min_wall_mm", "min_wall_source", "pass_axis",      "pass_width_mm",
    "pass_s",     "pass_source",    "spread_mm"};

/// Colours for roles that a profile does not name: told apart easily, never black.
const std::map<std::string, io::Rgb>& usual_colours() {
    static const std::map<std::string, io::Rgb> colours{{"C", {0, 150, 200}},   {"M", {205, 25, 110}},
                                                        {"Y", {250, 215, 30}},  {"K", {30, 30, 30}},
                                                        {"W", {220, 222, 216}}, {"T", {170, 205, 230}}};
    return colours;
}
constexpr std::array<io::Rgb, 10> spare_colours{{{230, 110, 20},
                                                 {60, 160, 60},
                                                 {110, 70, 180},
                                                 {150, 90, 50},
                                                 {240, 150, 170},
                                                 {120, 120, 120},
                                                 {20, 70, 120},
                                                 {170, 200, 60},
                                                 {100, 20, 30},
                                                 {60, 200, 180}}};

int whole_or(const io::JsonObject& file, std::string_view key, int least, int most, int absent) {
    if (!file.has(key)) return absent;
    return static_cast<int>(file.integer(key, static_cast<std::uint64_t>(least), static_cast<std::uint64_t>(most)));
}

bool flag(const io::JsonObject& file, std::string_view key) { return file.has(key) && file.boolean(key); }

std::vector<std::string> texts_or(const io::JsonObject& file, std::string_view key, std::vector<std::string> absent) {
    return file.has(key) ? file.texts(key) : std::move(absent);
}

std::map<std::string, std::string> text_map(const io::JsonObject& file, std::string_view key) {
    std::map<std::string, std::string> result;
    if (!file.has(key)) return result;
    const io::JsonObject object = file.object(key);
    for (const std::string& name : object.keys()) result[name] = object.text(name);
    return result;
}

io::Rgb read_rgb(const io::JsonObject& file, std::string_view key) {
    const auto values = file.integers(key, 3, 0, 255);
    return {static_cast<std::uint8_t>(values[0]), static_cast<std::uint8_t>(values[1]),
            static_cast<std::uint8_t>(values[2])};
}

Eigen::Vector3d read_pitch(const io::JsonObject& file) {
    if (file.has("pitch_um")) {
        if (file.has("dpi") || file.has("layer_um"))
            file.fail("pitch_um", "give either pitch_um or dpi and layer_um, not both");
        const std::vector<double> pitch = file.numbers("pitch_um", 3, smallest_pitch_um, largest_pitch_um);
        return {pitch[0], pitch[1], pitch[2]};
    }
    if (!file.has("dpi")) file.fail("pitch_um", "is missing: give the voxel size in micrometres, or dpi and layer_um");
    const std::vector<double> dpi =
        file.numbers("dpi", 2, um_per_inch / largest_pitch_um, um_per_inch / smallest_pitch_um);
    const double layer_um = file.number("layer_um", smallest_pitch_um, largest_pitch_um);
    return {um_per_inch / dpi[0], um_per_inch / dpi[1], layer_um};
}

Eigen::Vector3d read_tray(const io::JsonObject& file) {
    if (!file.has("tray_mm")) return Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    const std::vector<double> tray = file.numbers("tray_mm", 3, 1, 1e5);
    return {tray[0], tray[1], tray[2]};
}

void read_colours(const io::JsonObject& file, PrinterProfile& printer) {
    if (file.has("background_rgb")) printer.background_rgb = read_rgb(file, "background_rgb");
    if (!file.has("colours")) return;
    const io::JsonObject colours = file.object("colours");
    for (const std::string& role : colours.keys()) {
        const io::Rgb colour = read_rgb(colours, role);
        if (colour == printer.background_rgb)
            file.fail("colours",
                      fmt::format("'{}' has the colour of the background, which means \"print nothing\"", role));
        for (const auto& [other, other_colour] : printer.colours)
            if (other_colour == colour)
                file.fail(
                    "colours",
                    fmt::format("'{}' and '{}' share a colour, so the printer could not tell them apart", other, role));
        printer.colours[role] = colour;
    }
}

void read_roles(const io::JsonObject& file, PrinterProfile& printer) {
    printer.default_roles = texts_or(file, "default_roles", {"C", "M", "Y", "K", "W"});
    if (printer.default_roles.empty() || printer.default_roles.size() > static_cast<std::size_t>(printer.max_resins))
        file.fail("default_roles", fmt::format("{} roles, but 1 to {} resins can be loaded",
                                               printer.default_roles.size(), printer.max_resins));
    for (const std::string& role : printer.default_roles)
        if (role.empty() || std::count(printer.default_roles.begin(), printer.default_roles.end(), role) > 1)
            file.fail("default_roles", fmt::format("'{}' is empty or named twice", role));
}

void read_formats(const io::JsonObject& file, PrinterProfile& printer) {
    const std::vector<std::string> names = texts_or(file, "formats", {std::string(name_of(io::LayerFormat::png))});
    if (names.empty()) file.fail("formats", "name at least one");
    for (const std::string& name : names) {
        const auto format = value_of<io::LayerFormat>(name);
        if (!format)
            file.fail("formats", fmt::format("'{}' is none of {}", name, fmt::join(names_of<io::LayerFormat>(), ", ")));
        printer.formats.push_back(*format);
    }
}

void read_cartridges(const io::JsonObject& file, PrinterProfile& printer) {
    printer.material_names = text_map(file, "material_names");
    if (!file.has("cartridges")) return;
    if (file.has("material_names"))
        file.fail("cartridges", "has names of its own: give either these or material_names, not both");
    for (const io::JsonObject& entry : file.objects("cartridges")) {
        entry.allow_only({"family", "names"});
        const std::string family = entry.text("family");
        if (family.empty() || printer.takes(family))
            entry.fail("family", fmt::format("'{}' is empty or named twice", family));
        printer.cartridges.push_back({family, text_map(entry, "names")});
    }
    if (printer.cartridges.empty()) file.fail("cartridges", "is empty: name a family, or leave the key out");
    printer.material_names = printer.cartridges.front().names;
}

void read_unconfirmed(const io::JsonObject& file, PrinterProfile& printer) {
    printer.unconfirmed = text_map(file, "unconfirmed");
    const std::vector<std::string> keys(known_keys.begin(), known_keys.end());
    for (const auto& [key, why] : printer.unconfirmed)
        if (std::find(keys.begin(), keys.end(), key) == keys.end())
            file.fail("unconfirmed", io::unknown_key_message(key, keys));
}

void read_walls(const io::JsonObject& file, PrinterProfile& printer) {
    constexpr double least_mm = 0.01, most_mm = 100;
    if (!file.has("min_wall_mm")) return;
    printer.min_wall_mm = file.number("min_wall_mm", least_mm, most_mm);
    if (!file.has("min_wall_source") || file.text("min_wall_source").empty())
        file.fail("min_wall_source", "is missing: say who asks for min_wall_mm");
    printer.min_wall_source = file.text("min_wall_source");
}

HeadPasses read_passes(const io::JsonObject& file) {
    constexpr double least_mm = 0.1, most_mm = 1e4, least_s = 1e-3, most_s = 3600;
    HeadPasses passes;
    for (const char* key : {"pass_axis", "pass_s"})
        if (file.has(key) && !file.has("pass_width_mm"))
            file.fail(key, "says nothing without pass_width_mm, the width that one pass of the heads prints");
    if (!file.has("pass_width_mm")) return passes;
    passes.width_mm = file.number("pass_width_mm", least_mm, most_mm);
    if (!file.has("pass_source") || file.text("pass_source").empty())
        file.fail("pass_source", "is missing: say where pass_width_mm is from");
    passes.source = file.text("pass_source");
    if (file.has("pass_axis")) {
        const std::string axis = file.text("pass_axis");
        if (axis != "x" && axis != "y") file.fail("pass_axis", fmt::format("'{}' is none of x, y", axis));
        passes.along = axis == "x" ? 0 : 1;
    }
    if (file.has("pass_s")) passes.seconds = file.number("pass_s", least_s, most_s);
    return passes;
}

/// Of resin, along columns and rows.
std::array<double, 2> read_spread(const io::JsonObject& file) {
    if (!file.has("spread_mm")) return {};
    const std::vector<double> mm = file.numbers("spread_mm", 2, 0, std::numeric_limits<float>::max());
    for (const double one : mm)
        if (one > optics::widest_spread_mm)
            file.fail("spread_mm",
                      fmt::format("{:g} mm is wider than {:g} mm, at which no printer could place a voxel; give the "
                                  "standard deviation, in millimetres",
                                  one, optics::widest_spread_mm));
    return {mm[0], mm[1]};
}

PrinterProfile printer_from_json(const io::JsonObject& file, const std::string& id) {
    if (!file.has("format") || !file.is_text("format") || file.text("format") != "voxtone-printer")
        file.fail("format", "is not \"voxtone-printer\": this is not a printer profile");
    if (file.integer("version", 0, 1000000) != 1)
        file.fail("version", "is not 1: this program reads version 1 of printer profiles");
    file.allow_only(known_keys);
    PrinterProfile printer;
    printer.id = id;
    printer.name = file.text("name");
    if (printer.name.empty()) file.fail("name", "is empty");
    printer.pitch_um = read_pitch(file);
    printer.tray_mm = read_tray(file);
    printer.max_resins = whole_or(file, "max_resins", 1, halftone::max_resins, halftone::max_resins);
    printer.max_colours = whole_or(file, "max_colours", 1, most_colours, most_colours);
    printer.min_layers = whole_or(file, "min_layers", 1, 1'000'000, 1);
    read_colours(file, printer);
    read_roles(file, printer);
    read_formats(file, printer);
    read_unconfirmed(file, printer);
    printer.default_resins = file.has("default_resins") ? file.text("default_resins") : "vero-opaque";
    if (printer.default_resins.empty()) file.fail("default_resins", "is empty: name a resin set, or leave the key out");
    read_cartridges(file, printer);
    printer.orientation = {flag(file, "flip_x"), flag(file, "flip_y"), flag(file, "swap_xy")};
    read_walls(file, printer);
    if (file.has("utility")) printer.utility = file.text("utility");
    if (file.has("mode")) printer.mode = file.text("mode");
    printer.passes = read_passes(file);
    printer.spread_mm = read_spread(file);
    printer.notes = texts_or(file, "notes", {});
    return printer;
}

}  // namespace

std::optional<io::Rgb> usual_colour(const std::string& role) {
    const auto found = usual_colours().find(role);
    if (found == usual_colours().end()) return std::nullopt;
    return found->second;
}

PrinterProfile parse_printer(std::string_view json, const std::string& id, const std::string& where) {
    return printer_from_json(io::JsonObject::parse(json, where), id);
}

bool PrinterProfile::takes(const std::string& family) const {
    return std::ranges::find(cartridges, family, &Cartridges::family) != cartridges.end();
}

void PrinterProfile::load(const std::string& resin_set, const std::string& family) {
    if (family.empty() || cartridges.empty()) return;
    foreign_cartridges_.clear();
    material_names.clear();
    std::vector<std::string> known;
    for (const Cartridges& taken : cartridges) {
        if (taken.family == family) {
            material_names = taken.names;
            return;
        }
        known.push_back(taken.family);
    }
    foreign_cartridges_ = fmt::format(
        "--resins {}: its resins are those of {} cartridges, and printer {} takes {}, so that colours will not be "
        "those "
        "that are predicted; take a set of these (`voxtone list resins`), or calibrate one (docs/calibrate.md).",
        resin_set, family, id, fmt::join(known, ", "));
}

std::vector<std::string> PrinterProfile::warnings() const {
    std::vector<std::string> sentences;
    if (!foreign_cartridges_.empty()) sentences.push_back(named_warning("cartridges", foreign_cartridges_));
    for (const auto& [key, why] : unconfirmed)
        sentences.push_back(
            named_warning("unconfirmed", fmt::format("Printer {}: {} is not confirmed ({}).", id, key, why)));
    return sentences;
}

HeadPasses PrinterProfile::sliced_passes() const {
    HeadPasses sliced = passes;
    if (orientation.swap_xy) sliced.along = passes.across();
    return sliced;
}

io::StackDescription PrinterProfile::describe(const std::array<std::uint32_t, 3>& voxels) const {
    const Eigen::Vector3d pitch = sliced_pitch_um();
    io::StackDescription stack;
    stack.printer = id;
    stack.pitch_um = {pitch.x(), pitch.y(), pitch.z()};
    stack.spread_mm = sliced_spread_mm();
    stack.size_px = {voxels[0], voxels[1]};
    stack.layers = voxels[2];
    stack.background_rgb = background_rgb;
    stack.orientation = orientation;
    return stack;
}

std::vector<io::Rgb> PrinterProfile::display_colours(std::span<const std::string> roles) const {
    std::vector<io::Rgb> result;
    std::set<io::Rgb> taken{background_rgb};
    for (const auto& [role, colour] : colours)
        if (std::find(roles.begin(), roles.end(), role) != roles.end()) taken.insert(colour);
    const auto first_free = [&](const std::string& role) {
        if (const auto usual = usual_colours().find(role);
            usual != usual_colours().end() && !taken.contains(usual->second))
            return usual->second;
        for (const io::Rgb& colour : spare_colours)
            if (!taken.contains(colour)) return colour;
        throw InputError(fmt::format(
            "printer {}: no bitmap colour is left for role '{}'; give it one under \"colours\" in the profile", id,
            role));
    };
    for (const std::string& role : roles) {
        const auto own = colours.find(role);
        result.push_back(own != colours.end() ? own->second : first_free(role));
        taken.insert(result.back());
    }
    return result;
}

std::optional<std::string_view> known_printer_text(std::string_view id) {
    for (const EmbeddedFile& file : embedded::printers())
        if (file.name == id) return file.text;
    return std::nullopt;
}

namespace {

/// A printer's name as people write it, as an id has it.
std::string as_id(const std::string& name) {
    std::string id;
    for (const char c : name)
        id += c == ' ' || c == '_' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return id;
}

/// The digits of a name are the machine's: another number is another machine.
std::string digits_in(std::string_view name) {
    std::string digits;
    for (const char c : name)
        if (c >= '0' && c <= '9') digits += c;
    return digits;
}

/// In quotes; of a machine its modes; empty: none is near.
std::string nearest_printer(const std::string& name, const std::vector<std::string>& known) {
    const std::string id = as_id(name);
    std::vector<std::string> begun, same_machine;
    for (const std::string& candidate : known) {
        if (candidate == id || candidate.starts_with(id + "-")) begun.push_back(fmt::format("'{}'", candidate));
        if (digits_in(candidate) == digits_in(id)) same_machine.push_back(candidate);
    }
    if (!begun.empty()) return fmt::format("{}", fmt::join(begun, ", "));
    const std::string nearest = io::nearest_name(id, same_machine);
    return nearest.empty() ? nearest : fmt::format("'{}'", nearest);
}

}  // namespace

PrinterProfile find_printer(const std::string& id_or_path) {
    if (id_or_path.find('/') != std::string::npos || id_or_path.ends_with(".json")) {
        const std::filesystem::path path(id_or_path);
        return printer_from_json(io::JsonObject::read(path), path.stem().string());
    }
    std::vector<std::string> known;
    for (const EmbeddedFile& file : embedded::printers()) {
        if (file.name == id_or_path) return parse_printer(file.text, id_or_path, "profile " + id_or_path);
        known.emplace_back(file.name);
    }
    const std::string nearest = nearest_printer(id_or_path, known);
    throw InputError(fmt::format(
        "unknown printer '{}'{}; known are {}; your own profile is given as a path to its .json file", id_or_path,
        nearest.empty() ? "" : fmt::format(" (did you mean {}?)", nearest), fmt::join(known, ", ")));
}

std::vector<PrinterProfile> list_printers() {
    std::vector<PrinterProfile> printers;
    for (const EmbeddedFile& file : embedded::printers())
        printers.push_back(parse_printer(file.text, std::string(file.name), fmt::format("profile {}", file.name)));
    return printers;
}

}  // namespace voxtone::slicer

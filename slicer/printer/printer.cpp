// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/printer/printer.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <set>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "voxtone/base/embedded_file.h"
#include "voxtone/base/error.h"
#include "voxtone/halftone/separation/mixture.h"
#include "voxtone/io/files/json_keys.h"
#include "voxtone/io/layers/layer_runs.h"

namespace voxtone::embedded {
std::span<const EmbeddedFile> printers();
}

namespace voxtone::slicer {

namespace {

using Json = nlohmann::ordered_json;

constexpr double um_per_inch = 25400;
constexpr int most_colours = io::max_materials - 1;
/// No voxel of a material-jetting printer is near these limits; a figure beyond them is in the wrong unit.
constexpr double smallest_pitch_um = 1, largest_pitch_um = 1000;

const std::vector<std::string>& known_keys() {
    static const std::vector<std::string> keys{
        "format",     "version",        "name",    "dpi",         "layer_um", "pitch_um",       "tray_mm",
        "max_resins", "max_colours",    "formats", "min_layers",  "colours",  "background_rgb", "default_roles",
        "flip_x",     "material_names", "flip_y",  "unconfirmed", "swap_xy",  "notes"};
    return keys;
}

/// Colours for roles that a profile does not name: told apart easily, never black.
const std::map<std::string, Rgb8>& usual_colours() {
    static const std::map<std::string, Rgb8> colours{{"C", {0, 150, 200}},   {"M", {205, 25, 110}},
                                                     {"Y", {250, 215, 30}},  {"K", {30, 30, 30}},
                                                     {"W", {220, 222, 216}}, {"T", {170, 205, 230}}};
    return colours;
}
constexpr std::array<Rgb8, 10> spare_colours{{{230, 110, 20},
                                              {60, 160, 60},
                                              {110, 70, 180},
                                              {150, 90, 50},
                                              {240, 150, 170},
                                              {120, 120, 120},
                                              {20, 70, 120},
                                              {170, 200, 60},
                                              {100, 20, 30},
                                              {60, 200, 180}}};

/// Reads the keys of one profile and says what is wrong with them.
class ProfileReader {
public:
    ProfileReader(const Json& json, const std::string& where) : json_(json), where_(where) {}

    [[noreturn]] void fail(const std::string& key, const std::string& rule) const {
        throw InputError(fmt::format("{}: key '{}': {}", where_, key, rule));
    }
    [[nodiscard]] bool has(const char* key) const { return json_.contains(key); }

    [[nodiscard]] const Json& need(const char* key) const {
        if (!has(key)) fail(key, "is missing, and no printer can be described without it; see data/printers/README.md");
        return json_.at(key);
    }
    [[nodiscard]] std::string text(const char* key) const {
        const Json& value = need(key);
        if (!value.is_string() || value.get_ref<const std::string&>().empty())
            fail(key, "a text is expected, not " + shown(value));
        return value.get<std::string>();
    }
    [[nodiscard]] double number(const char* key, const Json& value, double low, double high) const {
        if (!value.is_number()) fail(key, "a number is expected, not " + shown(value));
        const double number = value.get<double>();
        if (!(number >= low && number <= high)) fail(key, fmt::format("{} is outside [{}, {}]", number, low, high));
        return number;
    }
    [[nodiscard]] int whole(const char* key, int low, int high, int absent) const {
        if (!has(key)) return absent;
        const Json& value = json_.at(key);
        if (!value.is_number_integer()) fail(key, "a whole number is expected, not " + shown(value));
        return static_cast<int>(number(key, value, low, high));
    }
    [[nodiscard]] bool flag(const char* key) const {
        if (!has(key)) return false;
        if (!json_.at(key).is_boolean()) fail(key, "true or false is expected, not " + shown(json_.at(key)));
        return json_.at(key).get<bool>();
    }
    [[nodiscard]] std::vector<double> numbers(const char* key, std::size_t count, double low, double high) const {
        const Json& value = need(key);
        if (!value.is_array() || value.size() != count)
            fail(key, fmt::format("{} numbers are expected, not {}", count, shown(value)));
        std::vector<double> result;
        for (const Json& item : value) result.push_back(number(key, item, low, high));
        return result;
    }
    [[nodiscard]] std::vector<std::string> texts(const char* key) const {
        std::vector<std::string> result;
        if (!has(key)) return result;
        if (!json_.at(key).is_array()) fail(key, "a list of texts is expected, not " + shown(json_.at(key)));
        for (const Json& item : json_.at(key)) {
            if (!item.is_string()) fail(key, "a list of texts is expected; it contains " + shown(item));
            result.push_back(item.get<std::string>());
        }
        return result;
    }
    [[nodiscard]] std::map<std::string, std::string> text_map(const char* key) const {
        std::map<std::string, std::string> result;
        for (const auto& [name, value] : object(key).items()) {
            if (!value.is_string()) fail(key, fmt::format("'{}': a text is expected, not {}", name, shown(value)));
            result[name] = value.get<std::string>();
        }
        return result;
    }
    [[nodiscard]] Rgb8 rgb(const char* key, const Json& value) const {
        if (!value.is_array() || value.size() != 3)
            fail(key, "a colour is three whole numbers from 0 to 255, not " + shown(value));
        Rgb8 result{};
        for (std::size_t c = 0; c < 3; ++c) {
            if (!value[c].is_number_integer())
                fail(key, "a colour is three whole numbers from 0 to 255, not " + shown(value));
            result[c] = static_cast<std::uint8_t>(number(key, value[c], 0, 255));
        }
        return result;
    }
    [[nodiscard]] const Json& object(const char* key) const {
        static const Json none = Json::object();
        if (!has(key)) return none;
        if (!json_.at(key).is_object()) fail(key, "an object {...} is expected, not " + shown(json_.at(key)));
        return json_.at(key);
    }

private:
    static std::string shown(const Json& value) {
        const std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
        return text.size() > 60 ? text.substr(0, 60) + "..." : text;
    }
    const Json& json_;
    const std::string& where_;
};

Json parse_json(std::string_view text, const std::string& where) {
    try {
        return Json::parse(text);
    } catch (const Json::parse_error& error) {
        const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
        throw InputError(fmt::format("{}: not valid JSON in line {}; a comma or a bracket may be missing there", where,
                                     1 + std::count(text.begin(), end, '\n')));
    } catch (const Json::out_of_range&) {
        throw InputError(fmt::format("{}: a number in it is too large for any computer to hold", where));
    }
}

void read_pitch(const ProfileReader& file, PrinterProfile& printer) {
    if (file.has("pitch_um")) {
        if (file.has("dpi") || file.has("layer_um"))
            file.fail("pitch_um", "give either pitch_um or dpi and layer_um, not both");
        const std::vector<double> pitch = file.numbers("pitch_um", 3, smallest_pitch_um, largest_pitch_um);
        printer.pitch_um = {pitch[0], pitch[1], pitch[2]};
        return;
    }
    if (!file.has("dpi")) file.fail("pitch_um", "is missing: give the voxel size in micrometres, or dpi and layer_um");
    const std::vector<double> dpi =
        file.numbers("dpi", 2, um_per_inch / largest_pitch_um, um_per_inch / smallest_pitch_um);
    const double layer_um = file.number("layer_um", file.need("layer_um"), smallest_pitch_um, largest_pitch_um);
    printer.pitch_um = {um_per_inch / dpi[0], um_per_inch / dpi[1], layer_um};
}

void read_colours(const ProfileReader& file, PrinterProfile& printer) {
    if (file.has("background_rgb")) printer.background_rgb = file.rgb("background_rgb", file.need("background_rgb"));
    for (const auto& [role, value] : file.object("colours").items()) {
        const Rgb8 colour = file.rgb("colours", value);
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

void read_roles(const ProfileReader& file, PrinterProfile& printer) {
    printer.default_roles =
        file.has("default_roles") ? file.texts("default_roles") : std::vector<std::string>{"C", "M", "Y", "K", "W"};
    if (printer.default_roles.empty() || printer.default_roles.size() > static_cast<std::size_t>(printer.max_resins))
        file.fail("default_roles", fmt::format("{} roles, but 1 to {} resins can be loaded",
                                               printer.default_roles.size(), printer.max_resins));
    for (const std::string& role : printer.default_roles)
        if (role.empty() || std::count(printer.default_roles.begin(), printer.default_roles.end(), role) > 1)
            file.fail("default_roles", fmt::format("'{}' is empty or named twice", role));
}

void read_formats(const ProfileReader& file, PrinterProfile& printer) {
    const std::vector<std::string> names = file.has("formats")
                                               ? file.texts("formats")
                                               : std::vector<std::string>{std::string(name_of(io::LayerFormat::png))};
    if (names.empty()) file.fail("formats", "name at least one");
    for (const std::string& name : names) {
        const auto format = value_of<io::LayerFormat>(name);
        if (!format)
            file.fail("formats", fmt::format("'{}' is none of {}", name, fmt::join(names_of<io::LayerFormat>(), ", ")));
        printer.formats.push_back(*format);
    }
}

void read_unconfirmed(const ProfileReader& file, PrinterProfile& printer) {
    printer.unconfirmed = file.text_map("unconfirmed");
    for (const auto& [key, why] : printer.unconfirmed)
        if (std::find(known_keys().begin(), known_keys().end(), key) == known_keys().end())
            file.fail("unconfirmed", io::unknown_key_message(key, known_keys()));
}

}  // namespace

PrinterProfile parse_printer(std::string_view json, const std::string& id, const std::string& where) {
    const Json parsed = parse_json(json, where);
    if (!parsed.is_object() || parsed.value("format", Json()) != "voxtone-printer")
        throw InputError(fmt::format("{}: not a printer profile: \"format\": \"voxtone-printer\" is missing", where));
    if (parsed.value("version", Json()) != 1)
        throw InputError(fmt::format("{}: key 'version': this program reads version 1 of printer profiles", where));
    for (const auto& [key, value] : parsed.items())
        if (std::find(known_keys().begin(), known_keys().end(), key) == known_keys().end())
            throw InputError(fmt::format("{}: {}", where, io::unknown_key_message(key, known_keys())));

    const ProfileReader file(parsed, where);
    PrinterProfile printer;
    printer.id = id;
    printer.name = file.text("name");
    read_pitch(file, printer);
    printer.tray_mm.setConstant(std::numeric_limits<double>::infinity());
    if (file.has("tray_mm")) {
        const std::vector<double> tray = file.numbers("tray_mm", 3, 1, 1e5);
        printer.tray_mm = {tray[0], tray[1], tray[2]};
    }
    printer.max_resins = file.whole("max_resins", 1, halftone::max_resins, halftone::max_resins);
    printer.max_colours = file.whole("max_colours", 1, most_colours, most_colours);
    printer.min_layers = file.whole("min_layers", 1, 1'000'000, 1);
    read_colours(file, printer);
    read_roles(file, printer);
    read_formats(file, printer);
    read_unconfirmed(file, printer);
    printer.material_names = file.text_map("material_names");
    printer.flip_x = file.flag("flip_x");
    printer.flip_y = file.flag("flip_y");
    printer.swap_xy = file.flag("swap_xy");
    printer.notes = file.texts("notes");
    return printer;
}

std::vector<std::string> PrinterProfile::warnings() const {
    std::vector<std::string> sentences;
    for (const auto& [key, why] : unconfirmed)
        sentences.push_back(fmt::format("Printer {}: {} is not confirmed ({}).", id, key, why));
    return sentences;
}

std::vector<Rgb8> PrinterProfile::display_colours(std::span<const std::string> roles) const {
    std::vector<Rgb8> result;
    std::set<Rgb8> taken{background_rgb};
    for (const auto& [role, colour] : colours)
        if (std::find(roles.begin(), roles.end(), role) != roles.end()) taken.insert(colour);
    const auto first_free = [&](const std::string& role) {
        if (const auto usual = usual_colours().find(role);
            usual != usual_colours().end() && !taken.contains(usual->second))
            return usual->second;
        for (const Rgb8& colour : spare_colours)
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

PrinterProfile find_printer(const std::string& id_or_path) {
    if (id_or_path.find('/') != std::string::npos || id_or_path.ends_with(".json")) {
        std::ifstream stream(id_or_path, std::ios::binary);
        const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
        if (!stream.is_open() || stream.bad())
            throw FileError(
                fmt::format("{}: the printer profile cannot be read; check the path and its permissions", id_or_path));
        return parse_printer(text, std::filesystem::path(id_or_path).stem().string(), id_or_path);
    }
    std::vector<std::string> known;
    for (const EmbeddedFile& file : embedded::printers()) {
        if (file.name == id_or_path) return parse_printer(file.text, id_or_path, "profile " + id_or_path);
        known.emplace_back(file.name);
    }
    const std::string nearest = io::nearest_name(id_or_path, known);
    throw InputError(fmt::format(
        "unknown printer '{}'{}; known are {}; your own profile is given as a path to its .json file", id_or_path,
        nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", nearest), fmt::join(known, ", ")));
}

std::vector<PrinterProfile> list_printers() {
    std::vector<PrinterProfile> printers;
    for (const EmbeddedFile& file : embedded::printers())
        printers.push_back(parse_printer(file.text, std::string(file.name), fmt::format("profile {}", file.name)));
    return printers;
}

}  // namespace voxtone::slicer

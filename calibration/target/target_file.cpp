// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/target/target_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "calibration/patches/patch_file.h"
#include "calibration/target/marker_pattern.h"
#include "io/files/json_object.h"

namespace voxtone::calibration {

namespace {

constexpr double largest_mm = 10000;

std::array<double, 4> numbers(const Area& area) {
    return {area.min_mm.x(), area.min_mm.y(), area.max_mm.x(), area.max_mm.y()};
}

Area area_of(const io::JsonObject& object, std::string_view key) {
    const std::vector<double> v = object.numbers(key, 4, 0, largest_mm);
    return {{v[0], v[1]}, {v[2], v[3]}};
}

Target from_json(const io::JsonObject& object, const std::string& source) {
    object.allow_only({"format", "version", "printer", "pitch_um", "layout", "roles", "light", "dark", "top_mm",
                       "base_mm", "size_mm", "dark_half_mm", "squares", "fiducials"});
    if (object.text("format") != "voxtone-target")
        object.fail("format", "must be \"voxtone-target\": this is no description of a calibration target");
    if (object.integer("version", 1, 1000000) != 1)
        object.fail("version", "only version 1 is known; a newer voxtone may read it");
    Target target;
    target.printer = object.text("printer");
    const std::vector<double> pitch = object.numbers("pitch_um", 3, 1e-3, 1e4),
                              size = object.numbers("size_mm", 2, 0, largest_mm);
    target.pitch_um = {pitch[0], pitch[1], pitch[2]};
    target.layout = object.text("layout");
    target.roles = object.texts("roles");
    target.light = object.text("light");
    target.dark = object.text("dark");
    target.top_mm = object.number("top_mm", 0, largest_mm);
    target.base_mm = object.number("base_mm", 0, largest_mm);
    target.size_mm = {size[0], size[1]};
    target.dark_half = area_of(object, "dark_half_mm");
    for (const io::JsonObject& square : object.objects("squares")) {
        square.allow_only({"top", "backing", "area_mm"});
        TargetSquare entry;
        try {
            entry.top = parse_mixture(square.text("top"));
        } catch (const InputError& error) {
            square.fail("top", error.what());
        }
        entry.backing = square.text("backing");
        entry.area = area_of(square, "area_mm");
        target.squares.push_back(std::move(entry));
    }
    const io::JsonObject fiducials = object.object("fiducials");
    fiducials.allow_only({"dictionary", "markers"});
    if (fiducials.text("dictionary") != marker_dictionary)
        fiducials.fail("dictionary", fmt::format("must be {}", marker_dictionary));
    for (const io::JsonObject& marker : fiducials.objects("markers")) {
        marker.allow_only({"id", "area_mm"});
        target.markers.push_back(
            {static_cast<int>(marker.integer("id", 0, marker_count - 1)), area_of(marker, "area_mm")});
    }
    target.validate(source);
    return target;
}

}  // namespace

std::string target_text(const Target& target) {
    using nlohmann::ordered_json;
    ordered_json json{{"format", "voxtone-target"},
                      {"version", 1},
                      {"printer", target.printer},
                      {"pitch_um", target.pitch_um},
                      {"layout", target.layout},
                      {"roles", target.roles},
                      {"light", target.light},
                      {"dark", target.dark},
                      {"top_mm", target.top_mm},
                      {"base_mm", target.base_mm},
                      {"size_mm", {target.size_mm.x(), target.size_mm.y()}},
                      {"dark_half_mm", numbers(target.dark_half)}};
    std::string text = "{";  // one line per key and per square reads better than one per number
    for (const auto& [key, value] : json.items())
        text += fmt::format("{}\"{}\": {}", text.size() > 1 ? ",\n " : "", key, value.dump());
    text += ",\n \"squares\": [";
    for (std::size_t s = 0; s < target.squares.size(); ++s) {
        const TargetSquare& square = target.squares[s];
        const ordered_json entry{
            {"top", mixture_text(square.top)}, {"backing", square.backing}, {"area_mm", numbers(square.area)}};
        text += fmt::format("{}\n  {}", s ? "," : "", entry.dump());
    }
    text += fmt::format("],\n \"fiducials\": {{\"dictionary\": \"{}\", \"markers\": [", marker_dictionary);
    for (std::size_t m = 0; m < target.markers.size(); ++m) {
        const ordered_json entry{{"id", target.markers[m].id}, {"area_mm", numbers(target.markers[m].area)}};
        text += fmt::format("{}\n  {}", m ? "," : "", entry.dump());
    }
    return text + "]}}\n";
}

Target parse_target(std::string_view text, const std::string& source) {
    return from_json(io::JsonObject::parse(text, source), source);
}

Target read_target(const std::filesystem::path& file) { return from_json(io::JsonObject::read(file), file.string()); }

}  // namespace voxtone::calibration

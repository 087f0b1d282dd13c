// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/target/target_file.h"

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/patches/patch_file.h"
#include "calibration/target/marker_pattern.h"
#include "calibration/target/target_surfaces.h"
#include "io/files/json_object.h"
#include "io/files/json_writer.h"

namespace voxtone::calibration {

namespace {

constexpr double largest_mm = 10000, most_voxels = 10000;

std::array<double, 4> numbers(const Area& area) {
    return {area.min_mm.x(), area.min_mm.y(), area.max_mm.x(), area.max_mm.y()};
}

Area area_of(const io::JsonObject& object, std::string_view key) {
    const std::vector<double> v = object.numbers(key, 4, 0, largest_mm);
    return {{v[0], v[1]}, {v[2], v[3]}};
}

Target from_json(const io::JsonObject& object, const std::string& source) {
    object.allow_only({"format", "version", "printer", "pitch_um", "layout", "roles", "light", "dark", "surfaces",
                       "top_mm", "base_mm", "size_mm", "dark_half_mm", "squares", "fiducials"});
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
    if (object.has("surfaces"))
        for (const io::JsonObject& one : object.objects("surfaces")) {
            one.allow_only({"name", "kind", "rgb"});
            PatchSurface surface{one.text("name"), {}, one.numbers("rgb", 3, 0, 1), {}};
            try {
                surface.kind = parse_surface_kind(one.text("kind"));
            } catch (const InputError& error) {
                one.fail("kind", error.what());
            }
            target.surfaces.push_back(std::make_shared<const PatchSurface>(std::move(surface)));
        }
    target.top_mm = object.number("top_mm", 0, largest_mm);
    target.base_mm = object.number("base_mm", 0, largest_mm);
    target.size_mm = {size[0], size[1]};
    target.dark_half = area_of(object, "dark_half_mm");
    for (const io::JsonObject& square : object.objects("squares")) {
        square.allow_only({"top", "backing", "area_mm", "depth_mm", "cell"});
        TargetSquare entry;
        try {
            entry.top = parse_mixture(square.text("top"));
        } catch (const InputError& error) {
            square.fail("top", error.what());
        }
        entry.backing = square.text("backing");
        entry.area = area_of(square, "area_mm");
        if (square.has("depth_mm")) entry.depth_mm = square.number("depth_mm", 1e-3, largest_mm);
        if (square.has("cell")) {
            const std::vector<double> cell = square.numbers("cell", 2, 1, most_voxels);
            entry.cell = {static_cast<int>(cell[0]), static_cast<int>(cell[1])};
            if (entry.cell[0] != cell[0] || entry.cell[1] != cell[1])
                square.fail("cell", "must be whole columns and rows");
        }
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
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-target").line().add("version", 1);
    json.line().add("printer", target.printer).line().add("pitch_um", target.pitch_um);
    json.line().add("layout", target.layout).line().add("roles", target.roles);
    json.line().add("light", target.light).line().add("dark", target.dark);
    if (!target.surfaces.empty()) {
        json.line().key("surfaces").begin_list();
        for (const auto& surface : target.surfaces)
            json.begin_object()
                .add("name", surface->name)
                .add("kind", surface_kind_text(surface->kind))
                .add("rgb", surface->rho)
                .end_object();
        json.end_list();
    }
    json.line().add("top_mm", target.top_mm).line().add("base_mm", target.base_mm);
    json.line().add("size_mm", target.size_mm).line().add("dark_half_mm", numbers(target.dark_half));
    json.line().key("squares").begin_list();
    for (const TargetSquare& square : target.squares) {
        json.line().begin_object().add("top", mixture_text(square.top)).add("backing", square.backing);
        json.add("area_mm", numbers(square.area));
        if (square.depth_mm > 0) json.add("depth_mm", square.depth_mm);
        if (square.is_checker()) json.add("cell", square.cell);
        json.end_object();
    }
    json.end_list().line().key("fiducials").begin_object().add("dictionary", marker_dictionary);
    json.key("markers").begin_list();
    for (const auto& marker : target.markers)
        json.line().begin_object().add("id", marker.id).add("area_mm", numbers(marker.area)).end_object();
    json.end_list().end_object().end_object();
    return json.text() + "\n";
}

Target parse_target(std::string_view text, const std::string& source) {
    return from_json(io::JsonObject::parse(text, source), source);
}

Target read_target(const std::filesystem::path& file) { return from_json(io::JsonObject::read(file), file.string()); }

}  // namespace voxtone::calibration

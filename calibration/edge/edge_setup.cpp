// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/edge/edge_setup.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "io/files/json_object.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "io/files/xxh64.h"

namespace voxtone::calibration {
namespace {

using io::JsonObject;

void read(const JsonObject& from, const char* key, double least, double most, double& value) {
    if (from.has(key)) value = from.number(key, least, most);
}

void read(const JsonObject& from, const char* key, bool& value) {
    if (from.has(key)) value = from.boolean(key);
}

void read(const JsonObject& from, const char* key, std::array<double, 3>& values) {
    if (!from.has(key)) return;
    const std::vector<double> given = from.numbers(key, 3, 0, 1);
    std::ranges::copy(given, values.begin());
}

void read_sheet(const JsonObject& sheet, EdgeSetup& setup) {
    sheet.allow_only({"white", "black", "surface", "index", "roughness"});
    read(sheet, "white", setup.white);
    read(sheet, "black", setup.black);
    read(sheet, "surface", setup.assembly.sheet_surface);
    read(sheet, "index", 1, 3, setup.assembly.sheet_index);
    read(sheet, "roughness", 0, 0.5, setup.assembly.sheet_roughness);
    for (std::size_t c = 0; c < 3; ++c) {
        if (setup.white[c] > 0.999) sheet.fail("white", "a sheet reflects at most 0.999");
        if (setup.white[c] <= setup.black[c])
            sheet.fail("white", "white must reflect more than black in every channel, or there is no edge to see");
    }
}

void read_layers(const JsonObject& root, EdgeSetup& setup) {
    optics::EdgeAssembly& assembly = setup.assembly;
    if (root.has("gel")) {
        const JsonObject gel = root.object("gel");
        gel.allow_only({"on", "index", "above_mm", "below_mm", "error_mm"});
        read(gel, "on", assembly.gel);
        read(gel, "index", 1, 3, assembly.gel_index);
        read(gel, "above_mm", 0, 1, assembly.gel_above_mm);
        read(gel, "below_mm", 0, 1, assembly.gel_below_mm);
        read(gel, "error_mm", 0, 0.5, setup.gel_error_mm);
    }
    if (root.has("glass")) {
        const JsonObject glass = root.object("glass");
        glass.allow_only({"on", "index", "thickness_mm"});
        read(glass, "on", assembly.glass);
        read(glass, "index", 1, 3, assembly.glass_index);
        read(glass, "thickness_mm", 0, 5, assembly.glass_mm);
    }
    if (root.has("slab")) {
        const JsonObject slab = root.object("slab");
        slab.allow_only({"index", "roughness", "thickness_error"});
        read(slab, "index", 1, 3, assembly.slab_index);
        read(slab, "roughness", 0, 0.5, assembly.slab_roughness);
        read(slab, "thickness_error", 0, 0.5, setup.thickness_error);
    }
}

void read_optics(const JsonObject& root, EdgeSetup& setup) {
    if (root.has("light")) {
        const JsonObject light = root.object("light");
        light.allow_only({"angle_deg", "half_width_deg"});
        read(light, "angle_deg", 0, 89, setup.assembly.light_deg);
        read(light, "half_width_deg", 0.5, 45, setup.assembly.light_half_width_deg);
        if (setup.assembly.light_deg - setup.assembly.light_half_width_deg < 0 ||
            setup.assembly.light_deg + setup.assembly.light_half_width_deg > 90)
            light.fail("half_width_deg",
                       "the ring of light reaches from angle - half width to angle + half width, "
                       "which must lie within 0 and 90 degrees");
    }
    if (root.has("camera")) {
        const JsonObject camera = root.object("camera");
        camera.allow_only({"pitch_mm", "width_mm", "blur_mm", "level_error"});
        read(camera, "pitch_mm", 0.002, 0.5, setup.pitch_mm);
        read(camera, "width_mm", 1, 20, setup.width_mm);
        read(camera, "blur_mm", 0, 1, setup.blur_mm);
        read(camera, "level_error", 0, 0.5, setup.level_error);
        if (setup.width_mm / setup.pitch_mm < 20)
            camera.fail("width_mm", "a profile needs at least 20 samples; make it wider or the pitch finer");
    }
}

}  // namespace

std::vector<double> EdgeSetup::positions() const {
    const auto half = static_cast<int>(std::floor(width_mm / pitch_mm / 2 + 1e-9));
    std::vector<double> x;
    for (int k = -half; k < half; ++k) x.push_back((k + 0.5) * pitch_mm);
    return x;
}

std::uint64_t EdgeSetup::scene_digest() const {
    const optics::EdgeAssembly& s = assembly;
    const std::string text =
        fmt::format("{} {} | {} {} {} {} | {} {} {} | {} {} {} | {} {}", s.slab_index, s.slab_roughness, s.gel,
                    s.gel_index, s.gel_above_mm, s.gel_below_mm, s.glass, s.glass_index, s.glass_mm, s.sheet_surface,
                    s.sheet_index, s.sheet_roughness, s.light_deg, s.light_half_width_deg);
    return io::xxh64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

EdgeSetup parse_edge_setup(std::string_view text, std::string source) {
    const JsonObject root = JsonObject::parse(text, std::move(source));
    root.allow_only({"format", "version", "sheet", "gel", "glass", "slab", "light", "camera"});
    if (root.text("format") != "voxtone-edge-setup") root.fail("format", "expected \"voxtone-edge-setup\"");
    static_cast<void>(root.integer("version", 1, 1));
    EdgeSetup setup;
    if (root.has("sheet")) read_sheet(root.object("sheet"), setup);
    read_layers(root, setup);
    read_optics(root, setup);
    return setup;
}

EdgeSetup read_edge_setup(const std::string& file) {
    if (file.empty()) return {};
    constexpr std::uint64_t most_bytes = 1u << 20;
    const std::vector<std::uint8_t> bytes = io::read_whole_file(file, most_bytes);
    return parse_edge_setup({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file);
}

std::string edge_setup_text(const EdgeSetup& setup) {
    const optics::EdgeAssembly& s = setup.assembly;
    io::JsonWriter json;
    json.begin_object().line().add("format", "voxtone-edge-setup").line().add("version", 1).line();
    json.key("sheet").begin_object().add("white", setup.white).add("black", setup.black);
    json.add("surface", s.sheet_surface).add("index", s.sheet_index).add("roughness", s.sheet_roughness);
    json.end_object().line().key("gel").begin_object().add("on", s.gel).add("index", s.gel_index);
    json.add("above_mm", s.gel_above_mm).add("below_mm", s.gel_below_mm).add("error_mm", setup.gel_error_mm);
    json.end_object().line();
    json.key("glass").begin_object().add("on", s.glass).add("index", s.glass_index);
    json.add("thickness_mm", s.glass_mm).end_object().line();
    json.key("slab").begin_object().add("index", s.slab_index).add("roughness", s.slab_roughness);
    json.add("thickness_error", setup.thickness_error).end_object().line();
    json.key("light").begin_object().add("angle_deg", s.light_deg).add("half_width_deg", s.light_half_width_deg);
    json.end_object().line().key("camera").begin_object().add("pitch_mm", setup.pitch_mm);
    json.add("width_mm", setup.width_mm).add("blur_mm", setup.blur_mm).add("level_error", setup.level_error);
    json.end_object().line().end_object();
    return json.text() + "\n";
}

}  // namespace voxtone::calibration

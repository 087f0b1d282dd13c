// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/edge/edge_setup.h"

#include <algorithm>
#include <cmath>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "io/files/json_object.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "io/files/xxh64.h"

namespace voxtone::calibration {
namespace {

using io::JsonObject;

struct Field {
    std::string_view key;
    std::variant<bool*, double*, std::array<double, 3>*> at;
    double least = 0, most = 1;
};

struct Section {
    const char* key;
    std::vector<Field> fields;
};

// All that a file says, in its order.
std::vector<Section> sections_of(EdgeSetup& s) {
    optics::EdgeAssembly& a = s.assembly;
    return {{"sheet",
             {{"white", &s.white},
              {"black", &s.black},
              {"surface", &a.sheet_surface},
              {"index", &a.sheet_index, 1, 3},
              {"roughness", &a.sheet_roughness, 0, 0.5}}},
            {"gel",
             {{"on", &a.gel},
              {"index", &a.gel_index, 1, 3},
              {"above_mm", &a.gel_above_mm},
              {"below_mm", &a.gel_below_mm},
              {"error_mm", &s.gel_error_mm, 0, 0.5}}},
            {"glass", {{"on", &a.glass}, {"index", &a.glass_index, 1, 3}, {"thickness_mm", &a.glass_mm, 0, 5}}},
            {"slab",
             {{"index", &a.slab_index, 1, 3},
              {"roughness", &a.slab_roughness, 0, 0.5},
              {"thickness_error", &s.thickness_error, 0, 0.5}}},
            {"light", {{"angle_deg", &a.light_deg, 0, 89}, {"half_width_deg", &a.light_half_width_deg, 0.5, 45}}},
            {"camera",
             {{"pitch_mm", &s.pitch_mm, 0.002, 0.5},
              {"width_mm", &s.width_mm, 1, 20},
              {"blur_mm", &s.blur_mm},
              {"level_error", &s.level_error, 0, 0.5}}}};
}

void read(const JsonObject& from, const Field& field) {
    const std::string key(field.key);
    if (!from.has(key)) return;
    if (bool* const* flag = std::get_if<bool*>(&field.at)) **flag = from.boolean(key);
    if (double* const* value = std::get_if<double*>(&field.at)) **value = from.number(key, field.least, field.most);
    if (std::array<double, 3>* const* values = std::get_if<std::array<double, 3>*>(&field.at))
        std::ranges::copy(from.numbers(key, 3, field.least, field.most), (*values)->begin());
}

void read_sections(const JsonObject& root, EdgeSetup& setup) {
    for (const Section& section : sections_of(setup)) {
        if (!root.has(section.key)) continue;
        const JsonObject from = root.object(section.key);
        std::vector<std::string> keys;
        for (const Field& field : section.fields) keys.emplace_back(field.key);
        from.allow_only(keys);
        for (const Field& field : section.fields) read(from, field);
    }
}

// What values have to do with each other.
void check_setup(const JsonObject& root, const EdgeSetup& setup) {
    const auto fail_unless = [&](bool holds, const char* section, const char* key, std::string_view why) {
        if (!holds && root.has(section)) root.object(section).fail(key, why);
    };
    for (std::size_t c = 0; c < 3; ++c) {
        fail_unless(setup.white[c] <= 0.999, "sheet", "white", "a sheet reflects at most 0.999");
        fail_unless(setup.white[c] > setup.black[c], "sheet", "white",
                    "white must reflect more than black in every channel, or there is no edge to see");
    }
    const double middle = setup.assembly.light_deg, half = setup.assembly.light_half_width_deg;
    fail_unless(middle - half >= 0 && middle + half <= 90, "light", "half_width_deg",
                "the ring of light reaches from angle - half width to angle + half width, which must lie within 0 and "
                "90 degrees");
    fail_unless(setup.width_mm / setup.pitch_mm >= 20, "camera", "width_mm",
                "a profile needs at least 20 samples; make it wider or the pitch finer");
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
    read_sections(root, setup);
    check_setup(root, setup);
    return setup;
}

EdgeSetup read_edge_setup(const std::string& file) {
    if (file.empty()) return {};
    constexpr std::uint64_t most_bytes = 1u << 20;
    const std::vector<std::uint8_t> bytes = io::read_whole_file(file, most_bytes);
    return parse_edge_setup({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file);
}

std::string edge_setup_text(const EdgeSetup& setup) {
    EdgeSetup said = setup;
    io::JsonWriter json;
    json.begin_object().line().add("format", "voxtone-edge-setup").line().add("version", 1).line();
    for (const Section& section : sections_of(said)) {
        json.key(section.key).begin_object();
        for (const Field& field : section.fields)
            std::visit([&](const auto* value) { json.add(field.key, *value); }, field.at);
        json.end_object().line();
    }
    json.end_object();
    return json.text() + "\n";
}

}  // namespace voxtone::calibration

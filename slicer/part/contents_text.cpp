// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/contents_text.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/units.h"
#include "io/files/json_writer.h"
#include "optics/colour/colour.h"

namespace voxtone::slicer {

namespace {

constexpr std::size_t most_materials_told = 8;

std::string colour_code(const std::array<double, 3>& rgb) {
    std::string code = "#";
    for (const double channel : rgb)
        code += fmt::format("{:02x}", std::clamp(int(std::lround(optics::srgb_encode(channel) * 255)), 0, 255));
    return code;
}

std::vector<std::string> kinds_of_colour(const ModelContents& contents) {
    std::vector<std::string> kinds;
    if (contents.format == "picture") kinds.emplace_back("picture");
    if (!contents.textures.empty()) kinds.emplace_back("textures");
    if (contents.vertex_colours) kinds.emplace_back("vertices");
    if (contents.material_colours) kinds.emplace_back("materials");
    return kinds;
}

void write_mesh(io::JsonWriter& json, const ModelContents& contents) {
    json.key("unit").begin_object().add("mm", contents.mm_per_unit).add("is", contents.unit_is).end_object();
    json.add("parts", contents.parts).add("triangles", contents.triangles).add("vertices", contents.vertices);
    json.key("textures").begin_list();
    for (const auto& px : contents.textures) json.begin_object().add("size_px", px).end_object();
    json.end_list().key("materials").begin_list();
    for (const ContentsMaterial& material : contents.materials) {
        json.begin_object().add("name", material.name).add("colour", colour_code(material.rgb));
        if (material.texture) json.add("texture", *material.texture);
        json.add("triangles", material.triangles).end_object();
    }
    json.end_list().key("beside").begin_list();
    for (const io::SideFile& file : contents.side_files)
        json.begin_object().add("file", file.name).add("found", !file.sha256.empty()).end_object();
    json.end_list();
}

void write_contents(io::JsonWriter& json, const ModelContents& contents) {
    json.begin_object().add("file", contents.file);
    if (!contents.error.empty()) {
        json.add("error", contents.error).add("exit_code", static_cast<int>(contents.exit_code)).end_object();
        return;
    }
    json.add("format", contents.format);
    if (contents.size_mm) json.add("size_mm", *contents.size_mm);
    json.add("colour", kinds_of_colour(contents));
    if (contents.format == "picture") {
        json.key("picture").begin_object().add("size_px", contents.picture_px);
        if (contents.dpi > 0) json.add("dpi", contents.dpi);
        json.end_object();
    } else {
        write_mesh(json, contents);
    }
    json.add("warnings", contents.warnings).add("notes", contents.notes);
    if (!contents.refused.empty()) json.add("refused", contents.refused);
    json.end_object();
}

std::string counted_things(std::size_t count, const char* one, const char* many) {
    return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string unit_text(const ModelContents& contents) {
    if (contents.unit_is == "assumed") return " (unit: mm assumed, the file says none)";
    return fmt::format(" (unit: {:g} mm {})", contents.mm_per_unit,
                       contents.unit_is == "asked" ? "as asked" : "by the file");
}

std::string colour_text(const ModelContents& contents) {
    std::vector<std::string> told;
    std::vector<std::string> pixels;
    for (const auto& px : contents.textures) pixels.push_back(fmt::format("{} x {} px", px[0], px[1]));
    if (!pixels.empty())
        told.push_back(fmt::format("{} {}", pixels.size() == 1 ? "texture" : "textures", fmt::join(pixels, ", ")));
    if (contents.vertex_colours) told.emplace_back("colours of vertices");
    if (contents.material_colours) told.emplace_back("colours of materials");
    return told.empty() ? "none" : fmt::format("{}", fmt::join(told, "; "));
}

std::string material_text(const ContentsMaterial& material) {
    const std::string colour =
        material.texture ? fmt::format("texture {}", *material.texture + 1) : colour_code(material.rgb);
    return fmt::format("{} {}", material.name.empty() ? "without a name" : material.name, colour);
}

std::string materials_text(const ModelContents& contents) {
    std::vector<std::string> told;
    for (const ContentsMaterial& material : contents.materials) {
        if (told.size() == most_materials_told) {
            told.push_back(fmt::format("and {} more", contents.materials.size() - told.size()));
            break;
        }
        told.push_back(material_text(material));
    }
    return fmt::format("{}", fmt::join(told, ", "));
}

std::string mesh_text(const ModelContents& contents) {
    std::string text = fmt::format("  {}, {}, {}\n", counted_things(contents.parts, "part", "parts"),
                                   counted_things(contents.triangles, "triangle", "triangles"),
                                   counted_things(contents.vertices, "vertex", "vertices"));
    text += fmt::format("  colour: {}\n", colour_text(contents));
    if (!contents.materials.empty()) text += fmt::format("  materials: {}\n", materials_text(contents));
    std::vector<std::string> missing;
    for (const io::SideFile& file : contents.side_files)
        if (file.sha256.empty()) missing.push_back(file.name);
    if (!missing.empty()) text += fmt::format("  not there: {}\n", fmt::join(missing, ", "));
    return text;
}

std::string one_text(const ModelContents& contents) {
    if (!contents.error.empty()) return fmt::format("{}\n  cannot be read: {}\n", contents.file, contents.error);
    const bool is_picture = contents.format == "picture";
    std::string text = fmt::format("{}: {}", contents.file, contents.format);
    if (is_picture) text += fmt::format(", {} x {} px", contents.picture_px[0], contents.picture_px[1]);
    if (contents.dpi > 0) text += fmt::format(" of {:.0f} dpi", contents.dpi);
    if (const auto& mm = contents.size_mm)
        text += fmt::format(", {:.4g} x {:.4g} x {:.4g} mm", (*mm)[0], (*mm)[1], (*mm)[2]);
    text += (is_picture ? std::string() : unit_text(contents)) + "\n";
    if (!is_picture) text += mesh_text(contents);
    for (const std::string& note : contents.notes) text += fmt::format("  {}\n", note);
    for (const std::string& warning : contents.warnings) text += fmt::format("  warning: {}\n", warning);
    if (!contents.refused.empty()) text += fmt::format("  would be refused: {}\n", contents.refused);
    return text;
}

}  // namespace

std::string contents_json(std::span<const ModelContents> files) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-contents").add("version", 1).key("files").begin_list();
    for (const ModelContents& contents : files) write_contents(json, contents);
    return json.end_list().end_object().text();
}

std::string contents_text(std::span<const ModelContents> files) {
    std::string text;
    for (const ModelContents& contents : files) text += one_text(contents);
    return text;
}

}  // namespace voxtone::slicer

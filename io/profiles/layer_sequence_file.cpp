// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/profiles/layer_sequence_file.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/units.h"
#include "io/files/json_object.h"
#include "io/files/json_writer.h"

namespace voxtone::io {
namespace {

constexpr double thinnest_mm = 1e-6, thickest_mm = 1e4;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// "W 0,5" would be a layer of 0 mm and one more.
void refuse_decimal_commas(std::string_view text) {
    for (std::size_t i = 1; i + 1 < text.size(); ++i)
        if (text[i] == ',' && is_digit(text[i - 1]) && is_digit(text[i + 1]))
            throw UsageError(fmt::format(
                "\"{}\": decimals stand behind a point, for a comma ends a layer: \"W 0.3, K 100um\"", text));
}

constexpr std::string_view former_format = "voxtone-stack";

LayerSequence sequence_from_json(const JsonObject& json) {
    json.allow_only({"format", "version", "name", "source", "resins", "surface", "backing", "layers"});
    if (const std::string format = json.text("format"); format != "voxtone-laminate" && format != former_format)
        json.fail("format", "is not \"voxtone-laminate\": this is no laminate");
    if (json.integer("version", 0, 1000000) != 1) json.fail("version", "is not 1, the only version this program knows");
    LayerSequence sequence;
    sequence.name = json.text("name");
    if (json.has("source")) sequence.source = json.text("source");
    if (json.has("resins")) sequence.resins = json.text("resins");
    sequence.surface = json.text("surface");
    if (sequence.surface != "air" && sequence.surface != "matched")
        json.fail("surface", "is neither \"air\" nor \"matched\"");
    sequence.backing = json.text("backing");
    for (const JsonObject& layer : json.objects("layers")) {
        layer.allow_only({"material", "mm"});
        sequence.layers.push_back({layer.text("material"), layer.number("mm", thinnest_mm, thickest_mm)});
    }
    return sequence;
}

std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

}  // namespace

LayerSequence parse_layer_sequence(std::string_view text, std::string source) {
    return sequence_from_json(JsonObject::parse(text, std::move(source)));
}

LayerSequence read_layer_sequence(const std::filesystem::path& file) {
    return sequence_from_json(JsonObject::read(file));
}

std::string layer_sequence_text(const LayerSequence& sequence) {
    JsonWriter json;
    json.begin_object().add("format", "voxtone-laminate").add("version", 1).add("name", sequence.name);
    json.line().add("source", sequence.source).line();
    if (!sequence.resins.empty()) json.add("resins", sequence.resins);
    json.add("surface", sequence.surface).add("backing", sequence.backing);
    json.line().key("layers").begin_list();
    for (const SequenceLayer& layer : sequence.layers)
        json.line().begin_object().add("material", layer.material).add("mm", layer.mm).end_object();
    json.end_list().end_object();
    return json.text() + "\n";
}

std::vector<SequenceLayer> parse_layers(std::string_view text) {
    refuse_decimal_commas(text);
    std::vector<SequenceLayer> layers;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const std::string_view layer = trimmed(text.substr(begin, end - begin));
        begin = end + 1;
        const std::size_t space = layer.find_first_of(" \t");
        if (space == std::string_view::npos)
            throw UsageError(fmt::format(
                "\"{}\": the layer \"{}\" is no material and thickness; write layers as \"W 0.3, K 100um\", "
                "or name the JSON file of a laminate",
                text, layer));
        const std::string material(layer.substr(0, space));
        const double mm = parse_length_mm(trimmed(layer.substr(space)), fmt::format("the layer of {}", material));
        if (!(mm >= thinnest_mm && mm <= thickest_mm))
            throw UsageError(fmt::format(
                "\"{}\": the layer of {} is {:g} mm thick; a layer has a thickness above 0: leave it out or "
                "give it one",
                text, material, mm));
        layers.push_back({material, mm});
    }
    return layers;
}

std::string layers_text(const std::vector<SequenceLayer>& layers) {
    std::string text;
    for (const SequenceLayer& layer : layers)
        text += fmt::format("{}{} {:.4g}", text.empty() ? "" : ", ", layer.material, layer.mm);
    return text;
}

}  // namespace voxtone::io

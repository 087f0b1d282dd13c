// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shards/shard_record.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <span>
#include <string_view>

#include <fmt/core.h>

#include "base/named_values.h"
#include "io/files/base64.h"
#include "io/files/json_object.h"
#include "io/files/json_writer.h"
#include "io/files/sha256.h"

template <>
struct voxtone::NamesOf<voxtone::io::ResinBitmaps> {
    using Bitmaps = io::ResinBitmaps;
    static constexpr auto table = std::to_array<Named<Bitmaps>>(
        {{Bitmaps::none, "none"}, {Bitmaps::png1, "png1"}, {Bitmaps::png8, "png8"}, {Bitmaps::tiff1, "tiff"}});
};

namespace voxtone::io {
namespace {

constexpr std::string_view seal_key = "shard_sha256";
constexpr std::uint64_t most_count = std::uint64_t{1} << 53;  // that JSON's numbers hold
constexpr double most_seconds = 1e9;

void add_figures(JsonWriter& json, const ShardFigures& f) {
    json.line().key("figures").begin_object();
    json.add("body_voxels", f.body_voxels).add("shell_voxels", f.shell_voxels).add("thin_voxels", f.thin_voxels);
    json.add("solid_s", f.solid_s).add("shell_s", f.shell_s).add("colour_s", f.colour_s).add("screen_s", f.screen_s);
    json.add("runs_s", f.runs_s).add("encode_s", f.encode_s).add("layers_s", f.layers_s).add("total_s", f.total_s);
    json.add("peak_memory_bytes", f.peak_memory_bytes).end_object();
}

ShardFigures figures_in(const JsonObject& json) {
    const auto count = [&](const char* key) { return json.integer(key, 0, most_count); };
    const auto seconds = [&](const char* key) { return json.number(key, 0, most_seconds); };
    return {.body_voxels = count("body_voxels"),
            .shell_voxels = count("shell_voxels"),
            .thin_voxels = count("thin_voxels"),
            .solid_s = seconds("solid_s"),
            .shell_s = seconds("shell_s"),
            .colour_s = seconds("colour_s"),
            .screen_s = seconds("screen_s"),
            .runs_s = seconds("runs_s"),
            .encode_s = seconds("encode_s"),
            .layers_s = seconds("layers_s"),
            .total_s = seconds("total_s"),
            .peak_memory_bytes = count("peak_memory_bytes")};
}

void add_layers(JsonWriter& json, const ShardRecord& record) {
    json.line().key("digests").begin_list();
    for (const std::uint64_t digest : record.written.digests) json.line().value(fmt::format("{:016x}", digest));
    json.end_list();
    json.line().key("bytes").begin_list();
    for (const auto& files : record.written.file_bytes) json.line().value(files);
    json.end_list();
    json.line().key("voxels").value(std::span(record.written.voxels).first(record.stack.resins.size() + 1));
}

std::uint64_t digest_in(const std::string& text, const JsonObject& json) {
    std::uint64_t digest = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), digest, 16);
    if (text.size() != 16 || error != std::errc() || end != text.data() + text.size())
        json.fail("digests", "holds something else than 16 hexadecimal digits a layer");
    return digest;
}

WrittenLayers layers_in(const JsonObject& json, std::uint32_t layers, std::size_t materials) {
    WrittenLayers written;
    for (const std::string& text : json.texts("digests")) written.digests.push_back(digest_in(text, json));
    for (const auto& files : json.number_lists("bytes", layers, 0, double(most_count)))
        written.file_bytes.emplace_back(files.begin(), files.end());
    if (written.digests.size() != layers) json.fail("digests", fmt::format("are not {}, one for each layer", layers));
    if (written.file_bytes.size() != layers) json.fail("bytes", fmt::format("are not of {} layers", layers));
    const auto voxels = json.integers("voxels", materials, 0, most_count);
    std::copy(voxels.begin(), voxels.end(), written.voxels.begin());
    return written;
}

void add_pictures(JsonWriter& json, const std::vector<ReportLayer>& pictures) {
    json.line().key("pictures").begin_list();
    for (const ReportLayer& layer : pictures) {
        const ReportPicture& picture = layer.picture;
        json.line().begin_object().add("layer", layer.number).add("height_mm", layer.height_mm);
        json.add("width_px", picture.width_px).add("height_px", picture.height_px);
        json.add("px_per_mm", picture.px_per_mm).add("png", base64(picture.file)).end_object();
    }
    json.end_list();
}

ReportLayer picture_in(const JsonObject& json) {
    constexpr std::uint64_t most_px = 100'000;
    json.allow_only({"layer", "height_mm", "width_px", "height_px", "px_per_mm", "png"});
    ReportLayer layer;
    layer.number = std::uint32_t(json.integer("layer", 0, 1'000'000));
    layer.height_mm = json.number("height_mm", 0, 1e6);
    layer.picture.width_px = std::uint32_t(json.integer("width_px", 1, most_px));
    layer.picture.height_px = std::uint32_t(json.integer("height_px", 1, most_px));
    layer.picture.px_per_mm = json.number("px_per_mm", 0, 1e6);
    for (const std::byte b : base64_bytes(json.text("png"))) layer.picture.file.push_back(std::uint8_t(b));
    return layer;
}

void add_viewer_layers(JsonWriter& json, const char* key, const std::vector<ViewerLayer>& layers) {
    json.line().key(key).begin_list();
    for (const ViewerLayer& layer : layers) {
        const std::span bytes(reinterpret_cast<const std::uint8_t*>(layer.deflated.data()), layer.deflated.size());
        json.line().begin_object().add("layer", layer.number).add("deflated", base64(bytes)).end_object();
    }
    json.end_list();
}

std::vector<ViewerLayer> viewer_layers_in(const JsonObject& json, const char* key, const ShardRecord& record) {
    std::vector<ViewerLayer> layers;
    for (const JsonObject& one : json.objects(key)) {
        one.allow_only({"layer", "deflated"});
        const auto number = std::uint32_t(one.integer("layer", 0, 1'000'000));
        if (number < record.first_layer || number - record.first_layer >= record.layers)
            one.fail("layer", "is none of this shard's");
        layers.push_back({number, base64_bytes(one.text("deflated"))});
    }
    return layers;
}

std::string text_of(const ShardRecord& r, const std::string& seal) {
    JsonWriter json;
    json.begin_object().add("format", "voxtone-shard").add("version", 1);
    json.line().add("shard", r.number.shard).add("of", r.number.of).add("first_task", r.first_task);
    json.add("first_layer", r.first_layer).add("layers", r.layers);
    json.line().add("program", r.program).add("host", r.host);
    json.line().add("job", r.job);
    json.line().key("stack");
    add_stack(json, r.stack);
    json.line().add("resin_bitmaps", name_of(r.resin_bitmaps)).add("gcvf", r.gcvf).add("png", r.png);
    json.add("topmost_digest", fmt::format("{:016x}", r.topmost_digest));
    add_layers(json, r);
    add_figures(json, r.figures);
    add_pictures(json, r.pictures);
    add_viewer_layers(json, "viewer_thinned", r.viewer.thinned);
    add_viewer_layers(json, "viewer_whole", r.viewer.whole);
    if (!seal.empty()) json.line().add(seal_key, seal);
    json.end_object();
    return json.text() + "\n";
}

std::string seal_of(const ShardRecord& record) {
    const std::string text = text_of(record, "");
    return sha256({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

ShardRecord record_in(const JsonObject& json, const std::string& file) {
    json.allow_only({"format",      "version",        "shard",          "of",           "first_task",
                     "first_layer", "layers",         "program",        "host",         "job",
                     "stack",       "resin_bitmaps",  "digests",        "bytes",        "voxels",
                     "figures",     "pictures",       "viewer_thinned", "viewer_whole", "gcvf",
                     "png",         "topmost_digest", seal_key});
    if (json.text("format") != "voxtone-shard") json.fail("format", "is not \"voxtone-shard\"");
    if (json.integer("version", 0, 1'000'000) != 1) json.fail("version", "is not 1, the only one that is known here");
    ShardRecord r;
    r.number.of = std::uint32_t(json.integer("of", 1, ShardNumber::most));
    r.number.shard = std::uint32_t(json.integer("shard", 1, r.number.of));
    r.first_task = std::uint32_t(json.integer("first_task", 0, 1u << 30));
    r.first_layer = std::uint32_t(json.integer("first_layer", 0, 1'000'000));
    r.layers = std::uint32_t(json.integer("layers", 0, 1'000'000));
    r.program = json.text("program");
    r.host = json.text("host");
    r.job = json.text("job");
    r.stack = stack_in(json.object("stack"), file);
    const auto bitmaps = value_of<ResinBitmaps>(json.text("resin_bitmaps"));
    if (!bitmaps) json.fail("resin_bitmaps", "is no kind of bitmaps that is known here");
    r.resin_bitmaps = *bitmaps;
    r.gcvf = json.boolean("gcvf");
    r.png = json.boolean("png");
    r.topmost_digest = digest_in(json.text("topmost_digest"), json);
    r.written = layers_in(json, r.layers, r.stack.resins.size() + 1);
    r.figures = figures_in(json.object("figures"));
    for (const JsonObject& picture : json.objects("pictures")) r.pictures.push_back(picture_in(picture));
    r.viewer.thinned = viewer_layers_in(json, "viewer_thinned", r);
    r.viewer.whole = viewer_layers_in(json, "viewer_whole", r);
    return r;
}

}  // namespace

std::string shard_json(const ShardRecord& record) { return text_of(record, seal_of(record)); }

ShardRecord read_shard(const std::filesystem::path& file) {
    // Whole layers of a full tray for the viewer come to some 250 MiB in base64.
    constexpr std::size_t most_bytes = std::size_t{1} << 30;
    const JsonObject json = JsonObject::read(file, most_bytes);
    ShardRecord record = record_in(json, file.string());
    if (json.text(seal_key) != seal_of(record)) json.fail(seal_key, "is not that of the rest, which was changed since");
    return record;
}

}  // namespace voxtone::io

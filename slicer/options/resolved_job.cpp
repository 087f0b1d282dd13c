// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/resolved_job.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "io/layers/stack_folder.h"
#include "io/models/foreign_kind.h"
#include "io/models/model_reader.h"
#include "slicer/options/option_scope.h"

namespace voxtone::slicer {

namespace {

void need(bool good, std::string_view key, const std::string& value, std::string_view rule) {
    if (!good) throw UsageError(fmt::format("--{} {}: {}", key, value, rule));
}

std::string mm(double length_mm) { return fmt::format("{}mm", length_mm); }

void check_common(const SliceOptions& o) {
    need(!o.model.empty(), "mesh", "(none)", "name a mesh or a picture");
    need(!o.out.empty(), "out", "(none)", "name the output folder: -o FOLDER");
    need(o.scale > 0, "scale", fmt::format("{}", o.scale), "must be above 0");
    need(o.size_mm >= 0, "size", mm(o.size_mm), "must be above 0");
    need(o.width_mm >= 0, "width", mm(o.width_mm), "must be above 0");
    need(o.thickness_mm > 0, "thickness", mm(o.thickness_mm), "must be above 0");
    need(o.depth_mm > 0 && o.depth_mm <= 10, "depth", mm(o.depth_mm), "must be above 0 and at most 10 mm");
    need(o.predict_cell_mm >= 0.01 && o.predict_cell_mm <= 5, "predict-cell", mm(o.predict_cell_mm),
         "must be 0.01 to 5 mm");
    need(o.viewing_distance_mm >= 10 && o.viewing_distance_mm <= 1e5, "viewing-distance", mm(o.viewing_distance_mm),
         "must be 10 mm to 100 m");
    need(o.verdict_good > 0, "verdict-good", fmt::format("{}", o.verdict_good), "must be above 0");
    need(o.verdict_bad >= o.verdict_good, "verdict-bad", fmt::format("{}", o.verdict_bad),
         "must not be below --verdict-good");
    need(o.memory_gib >= 0 && o.memory_gib <= most_memory_gib, "memory", fmt::format("{}", o.memory_gib),
         "must be above 0 GiB, or 0 for half of the machine's");
    need(o.read_memory_gib >= 0 && o.read_memory_gib <= 1e6, "read-memory", fmt::format("{}", o.read_memory_gib),
         "must be above 0 GiB, or 0 for half of the machine's");
    need(o.read_time_s > 0 && o.read_time_s <= 1e6, "read-time", fmt::format("{}", o.read_time_s),
         "must be above 0 and at most 1e6 s");
    need(o.read_size_gib > 0 && o.read_size_gib <= 1024, "read-size", fmt::format("{}", o.read_size_gib),
         "must be above 0 and at most 1024 GiB");
    need(o.read_megapixels > 0 && o.read_megapixels <= 4294, "read-pixels", fmt::format("{}", o.read_megapixels),
         "must be above 0 and at most 4294 million");
    need(o.shard.empty() || o.until == "end", "shard", o.shard, "a shard makes layers, and --until loop none");
    need(o.threads >= 0 && o.threads <= 1024, "threads", fmt::format("{}", o.threads), "must be 0 to 1024");
}

/// What only layers of profiles have is refused beside colours.
void check_not_layered(const SliceOptions& o) {
    constexpr std::string_view rule = "only goes with --model layered-profile";
    need(o.profiles.empty(), "profiles", o.profiles, rule);
    need(o.stack_materials.empty(), "stack-materials", fmt::format("{}", fmt::join(o.stack_materials, ",")), rule);
    need(!o.surfaces, "surfaces", "", rule);
}

void check_layered(const SliceOptions& o) {
    need(!o.profiles.empty(), "profiles", "(none)",
         "--model layered-profile needs a map of profiles (voxtone-profile-map)");
    need(parse_choice<ScreenKind>("screen", o.screen) == ScreenKind::blue_noise, "screen", o.screen,
         "layers are dithered by the screen blue-noise only");
    need(o.stack_thickness_mm > 0 && o.stack_thickness_mm <= 50, "stack-thickness", mm(o.stack_thickness_mm),
         "must be above 0 and at most 50 mm");
    need(o.stack_steps >= 1 && o.stack_steps <= 4096, "stack-steps", fmt::format("{}", o.stack_steps),
         "must be 1 to 4096");
    need(o.stack_blocks >= 1 && o.stack_blocks <= 16, "stack-blocks", fmt::format("{}", o.stack_blocks),
         "must be 1 to 16");
    need(parse_stack_rounds(o.stack_rounds).value_or(0) == 0 || o.stack_materials.empty(), "stack-rounds",
         o.stack_rounds, "measured materials have no medium that light could be traced through: 0 or auto");
    need(o.dc_weight > 0 && o.dc_weight <= 1e6, "dc-weight", fmt::format("{}", o.dc_weight),
         "must be above 0 and at most 1e6");
    need(o.layer_smoothing_mm >= 0 && o.layer_smoothing_mm <= 100, "layer-smoothing", mm(o.layer_smoothing_mm),
         "must be 0 to 100 mm");
    constexpr std::string_view whole = "does not go with --model layered-profile, which is sliced whole";
    need(o.shard.empty(), "shard", o.shard, whole);
    need(o.until == "end", "until", o.until, whole);
    need(o.surface_cell_mm >= 0.01 && o.surface_cell_mm <= 5, "surface-cell", mm(o.surface_cell_mm),
         "must be 0.01 to 5 mm");
}

PlacementOptions placement_of(const SliceOptions& o) {
    return {.unit = parse_file_unit(o.unit),
            .scale = o.scale,
            .size_mm = o.size_mm,
            .rotation = parse_rotation(o.rotate),
            .flip_x = o.flip_x,
            .flip_y = o.flip_y,
            .swap_xy = o.swap_xy};
}

io::ReadOptions reading_of(const SliceOptions& o) {
    constexpr double gib = 1 << 30;
    io::ReadOptions reading;
    if (o.read_memory_gib > 0) reading.memory_bytes = static_cast<std::uint64_t>(o.read_memory_gib * gib);
    reading.timeout_s = o.read_time_s;
    reading.max_file_bytes = reading.max_unpacked_bytes = static_cast<std::uint64_t>(o.read_size_gib * gib);
    reading.max_pixels = static_cast<std::uint64_t>(std::max(1.0, std::round(o.read_megapixels * 1e6)));
    reading.more = "--read-memory, --read-time";
    return reading;
}

LayeredOptions layered_of(const SliceOptions& o) {
    return {.profiles = o.profiles,
            .placement = parse_choice<ProfilePlacement>("profile-placement", o.profile_placement),
            .base = o.base,
            .thickness_mm = o.stack_thickness_mm,
            .steps = o.stack_steps,
            .blocks = o.stack_blocks,
            .rounds = parse_stack_rounds(o.stack_rounds),
            .materials = parse_stack_materials(o.stack_materials),
            .dc_weight = o.dc_weight,
            .clear_top = parse_clear_top(o.clear_top),
            .smoothing_mm = o.layer_smoothing_mm,
            .surfaces = o.surfaces,
            .surface_cell_mm = o.surface_cell_mm};
}

JobPredictionOptions prediction_of(const SliceOptions& o) {
    JobPredictionOptions prediction;
    prediction.automatic = o.predict == predict_auto;
    if (!prediction.automatic && o.predict != predict_none) {
        prediction.model = value_of<PredictionModel>(o.predict);
        if (!prediction.model) refuse_choice("predict", o.predict, predict_choices());
    }
    prediction.cell_mm = o.predict_cell_mm;
    prediction.memory_bytes = memory_budget(o.memory_gib);
    return prediction;
}

std::vector<io::LayerFormat> formats_of(const SliceOptions& o) {
    std::vector<io::LayerFormat> formats;
    for (const std::string& name : o.formats) formats.push_back(parse_choice<io::LayerFormat>("formats", name));
    return formats;
}

/// What a file is that cannot be read is more than that an option does not go with its name.
void refuse_foreign_files(const SliceOptions& o) {
    if (const std::string why = io::foreign_kind(o.model); !why.empty()) throw InputError(why);
    const bool is_named = io::is_model_name(o.model) || io::is_picture_name(o.model);
    if (!is_named && std::ranges::find(o.named, "size") != o.named.end())
        throw InputError(
            fmt::format("{} has no name of a model ({}), by which models are known, so that it is taken for a picture: "
                        "export a model as one of these, and give a picture --width in place of --size",
                        o.model, io::model_name_endings));
    if (o.texture.empty()) return;
    if (const std::string why = io::foreign_kind(o.texture, io::Wanted::picture); !why.empty())
        throw InputError("--texture: " + why);
}

}  // namespace

ResolvedJob resolve(const SliceOptions& o) {
    check_common(o);
    refuse_foreign_files(o);
    ResolvedJob job;
    job.asked = o;
    job.model = o.model;
    job.texture = o.texture;
    job.is_picture = !io::is_model_name(o.model);
    check_scope(o, job.is_picture);
    job.out = o.out;
    job.overwrite = o.overwrite;
    job.report = o.report;
    job.resume = o.resume;
    job.strict = o.strict;
    job.formats = formats_of(o);
    job.layers = parse_layer_range(o.layers);
    job.until = parse_choice<Until>("until", o.until);
    job.sharded = !o.shard.empty();
    job.shard = parse_shard(o.shard);
    job.printer = o.printer;
    job.resins = o.resins;
    job.load = o.load;
    job.placement = placement_of(o);
    job.picture = {o.width_mm, o.thickness_mm, parse_choice<optics::Backing>("backing", o.backing)};
    job.repair = parse_choice<RepairMode>("repair", o.repair);
    job.keep_thin = o.keep_thin;
    job.colour = {o.core, o.depth_mm, parse_choice<ScreenKind>("screen", o.screen),
                  parse_choice<Mixing>("mixing", o.mixing)};
    job.loop = {parse_iterations(o.iterations),
                parse_choice<halftone::Intent>("intent", o.intent),
                o.viewing_distance_mm,
                parse_choice<PredictionModel>("loop-model", o.loop_model),
                parse_choice<LoopMethod>("loop-method", o.loop_method),
                o.mixtures.empty() ? std::filesystem::path(o.out) / io::skin_name : std::filesystem::path(o.mixtures),
                !o.mixtures.empty(),
                !o.shard.empty()};
    job.prediction = prediction_of(o);
    job.reading = reading_of(o);
    job.verdict = {o.verdict_good, o.verdict_bad};
    job.seed = o.seed;
    job.threads = o.threads;
    if (parse_choice<Arrange>("model", o.arrange) == Arrange::colour) {
        check_not_layered(o);
    } else {
        check_layered(o);
        job.layered = layered_of(o);
    }
    return job;
}

}  // namespace voxtone::slicer

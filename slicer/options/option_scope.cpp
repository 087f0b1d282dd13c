// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/option_scope.h"

#include <algorithm>
#include <array>
#include <initializer_list>

#include <fmt/core.h>

#include "base/error.h"

namespace voxtone::slicer {

namespace {

constexpr std::array<std::string_view, 7> deciding_keys{"model",  "arrange",  "iterations", "predict",
                                                        "report", "surfaces", "size"};

const OptionSpec& spec_of(std::string_view key) {
    const auto table = slice_option_table();
    return *std::find_if(table.begin(), table.end(), [&](const OptionSpec& spec) { return spec.key == key; });
}

/// Refuses those of `keys` that the user named.
void idle(const SliceOptions& o, bool here, std::initializer_list<std::string_view> keys, std::string_view why) {
    if (!here) return;
    for (const std::string_view key : keys)
        if (std::find(o.named.begin(), o.named.end(), key) != o.named.end()) {
            const OptionSpec& spec = spec_of(key);
            throw UsageError(fmt::format("--{} {} would be ignored: {}", spec.option, spec.get(o), why));
        }
}

void check_scope_of_shape(const SliceOptions& o, bool is_picture) {
    idle(o, is_picture, {"size"}, "a picture has no --size; give --width and --thickness");
    idle(o, is_picture, {"texture"}, "it is for meshes; a picture is its own texture");
    idle(o, is_picture, {"unit"}, "it is the unit of a mesh's numbers; a picture is as wide as --width says");
    idle(o, is_picture, {"profile-placement"}, "on a picture's slab the map lies on the picture");
    idle(o, !is_picture, {"width", "thickness"}, "it is for pictures; --size scales a mesh");
    idle(o, !is_picture, {"backing"}, "a sheet lies under pictures only; a mesh floats in light");
    idle(o, o.size_mm > 0, {"scale"}, "--size decides how large the model is; give one of them");
}

void check_scope_of_colour(const SliceOptions& o) {
    idle(o, true,
         {"profile-placement", "stack-thickness", "stack-steps", "stack-blocks", "stack-rounds", "dc-weight",
          "clear-top", "base", "layer-smoothing", "surface-cell"},
         "it only goes with --model layered-profile");
    const bool looped = o.iterations != "0" || o.resume;  // what a loop has found may be printed
    idle(o, !looped, {"intent", "viewing-distance", "loop-model", "loop-method", "resume", "mixtures"},
         "--iterations 0 leaves the appearance loop out");
    const bool predicted = o.predict != predict_none && o.report;
    idle(o, !looped && !predicted, {"predict-cell"}, "there is neither a loop nor a prediction");
    idle(o, !o.report && o.predict != predict_auto && o.predict != predict_none, {"predict"},
         "it is for the report, which --no-report leaves out");
}

void check_scope_of_layers(const SliceOptions& o) {
    constexpr std::string_view why = "it only goes with --model colour";
    idle(o, true,
         {"texture", "core", "depth", "mixing", "intent", "viewing-distance", "loop-model", "loop-method", "resume",
          "predict-cell"},
         why);
    idle(o, true, {"mixtures"}, why);
    idle(o, o.iterations != "0", {"iterations"}, why);
    idle(o, o.predict != predict_none, {"predict"}, why);
    idle(o, !o.surfaces, {"surface-cell"}, "it is for the meshes of --surfaces");
}

}  // namespace

void check_scope(const SliceOptions& options, bool is_picture) {
    check_scope_of_shape(options, is_picture);
    if (options.arrange == "colour")
        check_scope_of_colour(options);
    else
        check_scope_of_layers(options);
}

bool decides_scope(std::string_view key) {
    return std::find(deciding_keys.begin(), deciding_keys.end(), key) != deciding_keys.end();
}

}  // namespace voxtone::slicer

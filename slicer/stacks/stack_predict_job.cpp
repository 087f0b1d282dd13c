// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/stacks/stack_predict_job.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "io/disk/output_files.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "io/profiles/profile_file.h"
#include "slicer/stacks/named_stack.h"
#include "slicer/stacks/profile_plots.h"
#include "slicer/stacks/spread_figures.h"

namespace voxtone::slicer {
namespace {

namespace fs = std::filesystem;
using optics::StackLight;

void check(const StackPredictJob& job, const StackSetting& setting) {
    check_paths(job.paths);
    if (job.check && !setting.traceable())
        throw UsageError(
            "--check: light can be traced through resins on black, white or air only; of measured profiles nothing "
            "else is "
            "known. Leave --check out.");
    for (const std::string& file : job.files) {
        const std::string ending = fs::path(file).extension().string();
        if (ending != ".json" && ending != ".svg")
            throw UsageError(fmt::format("{}: a predicted profile is written as .json or .svg", file));
    }
}

std::string profile_json(const StackSetting& setting, const io::LayerSequence& sequence, const StackLight& light) {
    io::ProfileFile file;
    file.name = sequence.name;
    file.source = fmt::format("voxtone stack predict, layer profiles of {} mm; surface {}, backing {}",
                              io::layers_text(sequence.layers), setting.surface_name(), setting.backing_name());
    file.channels = setting.channels();
    double mm = 0;
    for (const io::SequenceLayer& layer : sequence.layers) mm += layer.mm;
    for (std::size_t c = 0; c < light.R.size(); ++c)
        file.by_channel.push_back(
            {mm, profile_samples(setting.grid(), light.T[c]), profile_samples(setting.grid(), light.R[c])});
    return io::profile_text(file);
}

struct Prediction {
    StackLight layers, traced;  ///< traced: empty unless asked for
};

std::string drawing(const StackSetting& setting, const std::string& name, const Prediction& prediction) {
    ProfileRow R{"R of " + name, {{"layers", "#2266dd", prediction.layers.R, true}}};
    ProfileRow T{"T of " + name, {{"layers", "#2266dd", prediction.layers.T, true}}};
    if (!prediction.traced.R.empty()) {
        R.curves.insert(R.curves.begin(), {"Monte Carlo", "black", prediction.traced.R, false});
        T.curves.insert(T.curves.begin(), {"Monte Carlo", "black", prediction.traced.T, false});
    }
    return profile_plots(setting.grid(), setting.channel_names(), {std::move(R), std::move(T)}, 6);
}

void add_side(io::JsonWriter& json, const char* name, const StackSetting& setting,
              const std::vector<double>& coefficients, double error) {
    const SpreadFigures figures = spread_figures(setting.grid(), coefficients);
    json.key(name).begin_object().add("total", figures.total).add("half_within_mm", figures.half_mm);
    json.add("80_percent_within_mm", figures.most_mm);
    if (error > 0) json.add("standard_error", error);
    json.end_object();
}

void add_light(io::JsonWriter& json, const char* name, const StackSetting& setting, const StackLight& light,
               std::size_t c) {
    json.key(name).begin_object();
    add_side(json, "R", setting, light.R[c], light.R_error[c]);
    add_side(json, "T", setting, light.T[c], light.T_error[c]);
    json.end_object();
}

std::string light_text(const char* name, const StackSetting& setting, const StackLight& light, std::size_t c) {
    return fmt::format("  {} {}: {}; {}\n", setting.channel_name(c), name,
                       spread_text('R', spread_figures(setting.grid(), light.R[c]), light.R_error[c]),
                       spread_text('T', spread_figures(setting.grid(), light.T[c]), light.T_error[c]));
}

JobResult result_of(const NamedStack& stack, const Prediction& prediction) {
    const StackSetting& setting = stack.setting;
    const std::string layers = io::layers_text(stack.sequence.layers);
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-stack-prediction").add("version", 1).add("stack", layers);
    json.add("surface", setting.surface_name()).add("backing", setting.backing_name()).key("channels").begin_list();
    std::string text = fmt::format("{} mm, top first; surface {}, backing {}\n", layers, setting.surface_name(),
                                   setting.backing_name());
    for (std::size_t c = 0; c < setting.channels().size(); ++c) {
        json.begin_object().add("channel", setting.channel_name(c));
        add_light(json, "layers", setting, prediction.layers, c);
        text += light_text("layers", setting, prediction.layers, c);
        if (!prediction.traced.R.empty()) {
            add_light(json, "monte_carlo", setting, prediction.traced, c);
            text += light_text("Monte Carlo", setting, prediction.traced, c);
        }
        json.end_object();
    }
    json.end_list().end_object();
    return {json.text(), text};
}

}  // namespace

JobResult run_stack_predict(const StackPredictJob& job, Progress& progress) {
    const NamedStack stack = read_named_stack(job.stack, job.setting);
    check(job, stack.setting);
    io::expect_outputs({job.files.begin(), job.files.end()}, job.overwrite);
    Prediction prediction;
    prediction.layers = layered_light(stack, {job.paths, job.seed}, progress);
    if (job.check) prediction.traced = traced_light(stack, {job.paths, job.seed + 10000000}, progress);
    for (const std::string& file : job.files)
        io::write_whole_file(file, fs::path(file).extension() == ".svg"
                                       ? drawing(stack.setting, stack.sequence.name, prediction)
                                       : profile_json(stack.setting, stack.sequence, prediction.layers));
    return result_of(stack, prediction);
}

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/stacks/stack_predict_job.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "voxtone/io/files/whole_file.h"
#include "voxtone/io/profiles/profile_file.h"
#include "voxtone/slicer/stacks/named_stack.h"
#include "voxtone/slicer/stacks/profile_plots.h"

namespace voxtone::slicer {
namespace {

namespace fs = std::filesystem;
using optics::StackLight;

void check(const StackPredictJob& job, const StackSetting& setting) {
    if (job.paths < 2) throw UsageError(fmt::format("--paths: {}; at least 2 are needed", job.paths));
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
                              io::layers_text(sequence.layers), setting.surface(), setting.backing());
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
    std::vector<std::string> channels;
    for (std::size_t c = 0; c < setting.channels().size(); ++c) channels.push_back(setting.channel_name(c));
    ProfileRow R{"R of " + name, {{"layers", "#2266dd", prediction.layers.R, true}}};
    ProfileRow T{"T of " + name, {{"layers", "#2266dd", prediction.layers.T, true}}};
    if (!prediction.traced.R.empty()) {
        R.curves.insert(R.curves.begin(), {"Monte Carlo", "black", prediction.traced.R, false});
        T.curves.insert(T.curves.begin(), {"Monte Carlo", "black", prediction.traced.T, false});
    }
    return profile_plots(setting.grid(), channels, {std::move(R), std::move(T)}, 6);
}

nlohmann::ordered_json figures(const StackSetting& setting, const StackLight& light, std::size_t c) {
    const optics::HankelGrid& grid = setting.grid();
    const auto side = [&](const std::vector<double>& k, double error) {
        nlohmann::ordered_json json{{"total", k[0]},
                                    {"half_within_mm", optics::radius_of_share(grid, k, 0.5)},
                                    {"80_percent_within_mm", optics::radius_of_share(grid, k, 0.8)}};
        if (error > 0) json["standard_error"] = error;
        return json;
    };
    return {{"R", side(light.R[c], light.R_error[c])}, {"T", side(light.T[c], light.T_error[c])}};
}

std::string line(const char* name, const StackSetting& setting, const StackLight& light, std::size_t c) {
    const optics::HankelGrid& grid = setting.grid();
    const auto side = [&](char letter, const std::vector<double>& k, double error) {
        return fmt::format("{} {:.4f}{}, half of it within {:.2f} mm, 80 % within {:.2f} mm", letter, k[0],
                           error > 0 ? fmt::format(" +- {:.4f}", error) : std::string(),
                           optics::radius_of_share(grid, k, 0.5), optics::radius_of_share(grid, k, 0.8));
    };
    return fmt::format("  {} {}: {}; {}\n", setting.channel_name(c), name, side('R', light.R[c], light.R_error[c]),
                       side('T', light.T[c], light.T_error[c]));
}

}  // namespace

StackJobResult run_stack_predict(const StackPredictJob& job, Progress& progress) {
    const NamedStack stack =
        read_named_stack(job.stack, {job.resins, job.surface, job.backing, job.reach_mm, job.coefficients});
    const auto& [sequence, setting, layers] = stack;
    check(job, setting);
    Prediction prediction;
    prediction.layers = layered_light(stack, {job.paths, job.seed}, progress);
    if (job.check) prediction.traced = traced_light(stack, {job.paths, job.seed + 10000000}, progress);
    for (const std::string& file : job.files)
        io::write_whole_file(file, fs::path(file).extension() == ".svg"
                                       ? drawing(setting, sequence.name, prediction)
                                       : profile_json(setting, sequence, prediction.layers));
    nlohmann::ordered_json channels = nlohmann::json::array();
    std::string text = fmt::format("{} mm, top first; surface {}, backing {}\n", io::layers_text(sequence.layers),
                                   setting.surface(), setting.backing());
    for (std::size_t c = 0; c < setting.channels().size(); ++c) {
        channels.push_back({{"channel", setting.channel_name(c)}, {"layers", figures(setting, prediction.layers, c)}});
        text += line("layers", setting, prediction.layers, c);
        if (prediction.traced.R.empty()) continue;
        channels.back()["monte_carlo"] = figures(setting, prediction.traced, c);
        text += line("Monte Carlo", setting, prediction.traced, c);
    }
    nlohmann::ordered_json json{{"format", "voxtone-stack-prediction"},
                                {"version", 1},
                                {"stack", io::layers_text(sequence.layers)},
                                {"surface", setting.surface()},
                                {"backing", setting.backing()},
                                {"channels", channels}};
    return {json.dump(), text};
}

}  // namespace voxtone::slicer

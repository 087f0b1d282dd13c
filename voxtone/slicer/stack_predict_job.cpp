// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/stack_predict_job.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "voxtone/io/layer_sequence_file.h"
#include "voxtone/io/profile_file.h"
#include "voxtone/io/whole_file.h"
#include "voxtone/optics/resin_profile.h"
#include "voxtone/slicer/profile_plots.h"

namespace voxtone::slicer {
namespace {

namespace fs = std::filesystem;
using optics::StackLight;

constexpr double blur = 0.75;  // of reach / n

io::LayerSequence read_stack(const StackPredictJob& job) {
    io::LayerSequence sequence;
    if (fs::path(job.stack).extension() == ".json" && job.stack.find_first_of(" ,") == std::string::npos) {
        sequence = io::read_layer_sequence(job.stack);
    } else {
        sequence.name = job.stack;
        sequence.layers = io::parse_layers(job.stack);
        sequence.resins = "vero-opaque";
        sequence.surface = "auto";
    }
    if (!job.resins.empty()) sequence.resins = job.resins;
    if (!job.surface.empty()) sequence.surface = job.surface;
    if (!job.backing.empty()) sequence.backing = job.backing;
    if (sequence.layers.empty()) throw InputError(fmt::format("{}: has no layer; there is nothing to predict", job.stack));
    return sequence;
}

StackSetting setting_of(const StackPredictJob& job, const io::LayerSequence& sequence) {
    StackSettingOptions options;
    for (const io::SequenceLayer& layer : sequence.layers)
        if (std::find(options.materials.begin(), options.materials.end(), layer.material) == options.materials.end())
            options.materials.push_back(layer.material);
    options.resins = sequence.resins;
    options.surface = sequence.surface;
    options.backing = sequence.backing;
    options.reach_mm = job.reach_mm;
    options.coefficients = job.coefficients;
    return StackSetting(options);
}

std::vector<halftone::StackLayer> layers_of(const io::LayerSequence& sequence, const StackSetting& setting) {
    std::vector<halftone::StackLayer> layers;
    for (const io::SequenceLayer& layer : sequence.layers) {
        const auto material = std::find(setting.names().begin(), setting.names().end(), layer.material);
        layers.push_back({static_cast<std::size_t>(material - setting.names().begin()), layer.mm});
    }
    return layers;
}

void check(const StackPredictJob& job, const StackSetting& setting) {
    if (job.paths < 2) throw UsageError(fmt::format("--paths: {}; at least 2 are needed", job.paths));
    if (job.check && !setting.traceable())
        throw UsageError(
            "--check: light can be traced through resins on black, white or air only; of measured profiles nothing else is "
            "known. Leave --check out.");
    for (const std::string& file : job.files) {
        const std::string ending = fs::path(file).extension().string();
        if (ending != ".json" && ending != ".svg")
            throw UsageError(fmt::format("{}: a predicted profile is written as .json or .svg", file));
    }
}

// Of measured profiles, or on a measured backing: the surface is a layer of its own.
StackLight profiles_of(const StackSetting& setting, std::span<const halftone::StackLayer> layers,
                       const std::vector<halftone::StackMaterial>& materials) {
    StackLight light;
    const std::size_t n = setting.grid().size();
    for (std::size_t c = 0; c < setting.channels().size(); ++c) {
        optics::LayerProfile all = optics::smooth_surface(setting.ends().eta_top, n);
        for (const halftone::StackLayer& layer : layers)
            all = optics::stack(all, materials[layer.material][c].of_thickness(layer.thickness_mm));
        if (setting.ends().eta_bottom > 1) {
            all = optics::stack(all, optics::turned_over(optics::smooth_surface(setting.ends().eta_bottom, n)));
        } else if (!setting.backing_reflection().empty()) {
            const std::vector<double>& R = setting.backing_reflection()[c];
            all = optics::stack(all, {std::vector<double>(n, 1.0), R, R});
        }
        light.R.push_back(all.R_top);
        light.T.push_back(all.T);
    }
    light.R_error.assign(light.R.size(), 0.0);
    light.T_error = light.R_error;
    return light;
}

StackLight layered(const StackPredictJob& job, const StackSetting& setting, std::span<const halftone::StackLayer> layers,
                   Progress& progress) {
    const optics::LayerPathOptions tracing{job.paths, job.seed};
    if (setting.traceable())
        return optics::layered_light(*setting.resins(), setting.resin_layers(layers), setting.ends(), setting.grid(), tracing,
                                     &progress);
    double mm = 0;
    for (const halftone::StackLayer& layer : layers) mm += layer.thickness_mm;
    return profiles_of(setting, layers, setting.materials(0, mm, tracing, progress));
}

// Half as wide a blur as pictures have: it takes the ripples of a series that ends down to 6 %, and of what coarser grids can see
// next to nothing.
optics::RadialSamples sampled(const optics::HankelGrid& grid, const std::vector<double>& coefficients) {
    const std::size_t n = 2 * grid.size();
    const std::vector<double> soft = grid.blurred(coefficients, blur * grid.reach_mm() / static_cast<double>(grid.size()));
    optics::RadialSamples samples;
    samples.spacing_mm = grid.reach_mm() / static_cast<double>(n);
    for (std::size_t i = 0; i <= n; ++i)
        samples.light.push_back(grid.profile(soft, std::min(grid.reach_mm(), static_cast<double>(i) * samples.spacing_mm)));
    samples.total = std::clamp(coefficients[0], 0.0, 1.0);
    return samples;
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
        file.by_channel.push_back({mm, sampled(setting.grid(), light.T[c]), sampled(setting.grid(), light.R[c])});
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
                           error > 0 ? fmt::format(" +- {:.4f}", error) : std::string(), optics::radius_of_share(grid, k, 0.5),
                           optics::radius_of_share(grid, k, 0.8));
    };
    return fmt::format("  {} {}: {}; {}\n", setting.channel_name(c), name, side('R', light.R[c], light.R_error[c]),
                       side('T', light.T[c], light.T_error[c]));
}

}  // namespace

StackJobResult run_stack_predict(const StackPredictJob& job, Progress& progress) {
    const io::LayerSequence sequence = read_stack(job);
    const StackSetting setting = setting_of(job, sequence);
    check(job, setting);
    const std::vector<halftone::StackLayer> layers = layers_of(sequence, setting);
    Prediction prediction;
    prediction.layers = layered(job, setting, layers, progress);
    if (job.check)
        prediction.traced = optics::traced_light(*setting.resins(), setting.resin_layers(layers), setting.ends(), setting.grid(),
                                                 {job.paths, job.seed + 10000000}, &progress);
    for (const std::string& file : job.files)
        io::write_whole_file(file, fs::path(file).extension() == ".svg" ? drawing(setting, sequence.name, prediction)
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

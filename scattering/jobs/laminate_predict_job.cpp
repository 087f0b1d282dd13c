// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/jobs/laminate_predict_job.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "io/disk/output_files.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "io/profiles/profile_file.h"
#include "scattering/jobs/named_laminate.h"
#include "scattering/jobs/profile_plots.h"
#include "scattering/jobs/spread_figures.h"

namespace voxtone::scattering {
namespace {

namespace fs = std::filesystem;
using optics::LaminateLight;

void check(const LaminatePredictJob& job, const LaminateSetting& setting) {
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

std::string profile_json(const LaminateSetting& setting, const io::LayerSequence& sequence,
                         const LaminateLight& light) {
    io::ProfileFile file;
    file.name = sequence.name;
    file.source = fmt::format("voxtone laminate predict, layer profiles of {} mm; surface {}, backing {}",
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
    LaminateLight layers, traced;  ///< traced: empty unless asked for
};

std::string drawing(const LaminateSetting& setting, const std::string& name, const Prediction& prediction) {
    ProfileRow R{"R of " + name, {{"layers", "#2266dd", prediction.layers.R, true}}};
    ProfileRow T{"T of " + name, {{"layers", "#2266dd", prediction.layers.T, true}}};
    if (!prediction.traced.R.empty()) {
        R.curves.insert(R.curves.begin(), {"Monte Carlo", "black", prediction.traced.R, false});
        T.curves.insert(T.curves.begin(), {"Monte Carlo", "black", prediction.traced.T, false});
    }
    return profile_plots(setting.grid(), setting.channel_names(), {std::move(R), std::move(T)}, 6);
}

void add_side(io::JsonWriter& json, const char* name, const LaminateSetting& setting,
              const std::vector<double>& coefficients, double error) {
    const SpreadFigures figures = spread_figures(setting.grid(), coefficients);
    json.key(name).begin_object().add("total", figures.total).add("half_within_mm", figures.half_mm);
    json.add("80_percent_within_mm", figures.most_mm);
    if (error > 0) json.add("standard_error", error);
    json.end_object();
}

void add_light(io::JsonWriter& json, const char* name, const LaminateSetting& setting, const LaminateLight& light,
               std::size_t c) {
    json.key(name).begin_object();
    add_side(json, "R", setting, light.R[c], light.R_error[c]);
    add_side(json, "T", setting, light.T[c], light.T_error[c]);
    json.end_object();
}

std::string light_text(const char* name, const LaminateSetting& setting, const LaminateLight& light, std::size_t c) {
    return fmt::format("  {} {}: {}; {}\n", setting.channel_name(c), name,
                       spread_text('R', spread_figures(setting.grid(), light.R[c]), light.R_error[c]),
                       spread_text('T', spread_figures(setting.grid(), light.T[c]), light.T_error[c]));
}

JobResult result_of(const NamedLaminate& laminate, const Prediction& prediction) {
    const LaminateSetting& setting = laminate.setting;
    const std::string layers = io::layers_text(laminate.sequence.layers);
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-laminate-prediction").add("version", 1).add("laminate", layers);
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

JobResult run_laminate_predict(const LaminatePredictJob& job, Progress& progress) {
    const NamedLaminate laminate = read_named_laminate(job.laminate, job.setting);
    check(job, laminate.setting);
    io::expect_outputs({job.files.begin(), job.files.end()}, job.overwrite);
    Prediction prediction;
    prediction.layers = layered_light(laminate, {job.paths, job.seed}, progress);
    if (job.check) prediction.traced = traced_light(laminate, {job.paths, job.seed + 10000000}, progress);
    for (const std::string& file : job.files)
        io::write_whole_file(file, fs::path(file).extension() == ".svg"
                                       ? drawing(laminate.setting, laminate.sequence.name, prediction)
                                       : profile_json(laminate.setting, laminate.sequence, prediction.layers));
    return result_of(laminate, prediction);
}

}  // namespace voxtone::scattering

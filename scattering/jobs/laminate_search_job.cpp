// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/jobs/laminate_search_job.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/stopwatch.h"
#include "base/units.h"
#include "io/disk/output_files.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "io/profiles/layer_sequence_file.h"
#include "optics/profiles/wave_laminates.h"
#include "scattering/design/laminate_design.h"
#include "scattering/jobs/profile_plots.h"

namespace voxtone::scattering {
namespace {

namespace fs = std::filesystem;

/// Of one target: searching and refining, all rounds; correcting.
struct Times {
    double search_ms = 0, judge_ms = 0;
};

struct Target {
    std::string file, name;
    ChannelProfiles wanted;
};

void check(const LaminateSearchJob& job) {
    if (job.targets.empty())
        throw UsageError("laminate search: no target; name profile files (voxtone-profile) of what is wanted");
    if (job.rounds < 0 || job.rounds > 20)
        throw UsageError(fmt::format("--rounds: {}; it lies between 0 and 20", job.rounds));
    check_paths(job.paths);
    if (!(job.layer_mm >= 0))
        throw UsageError(fmt::format("--layer: {:g} mm; a printed layer is not thinner than 0", job.layer_mm));
    if (!(job.thickness_mm > 0))
        throw UsageError(fmt::format("--thickness: {:g} mm; a laminate needs a thickness above 0", job.thickness_mm));
}

// "T=0.2mm" for each material that is named.
std::vector<double> clear_top(const LaminateSearchJob& job, const std::vector<std::string>& names) {
    std::vector<double> clear;
    for (const std::string& rule : job.clear_top) {
        const std::size_t equals = rule.find('=');
        const auto named = std::find(names.begin(), names.end(), rule.substr(0, equals));
        if (equals == std::string::npos || named == names.end())
            throw UsageError(
                fmt::format("--clear-top: '{}' is no MATERIAL=LENGTH with one of the materials {}; write T=0.2mm", rule,
                            fmt::join(names, ", ")));
        clear.resize(names.size());
        clear[static_cast<std::size_t>(named - names.begin())] =
            parse_length_mm(rule.substr(equals + 1), "--clear-top");
    }
    return clear;
}

std::vector<Target> read_targets(const LaminateSearchJob& job, const LaminateSetting& setting, Progress& progress) {
    std::vector<Target> targets;
    std::set<std::string> names;
    for (const std::string& file : job.targets) {
        const std::string name = fs::path(file).stem().string();
        if (!names.insert(name).second)
            throw UsageError(
                fmt::format("{}: there are two targets named {}; their results would overwrite each other: rename one",
                            file, name));
        targets.push_back({file, name, setting.target(io::read_profile(file), file, progress)});
    }
    return targets;
}

fs::path output_folder(const LaminateSearchJob& job, const std::vector<Target>& targets) {
    std::vector<fs::path> names;
    for (const Target& target : targets)
        for (const char* ending : {".laminate.json", ".svg"}) names.emplace_back(target.name + ending);
    return io::make_folder_for(job.out, names, job.overwrite);
}

io::LayerSequence sequence_of(const LaminateSearchJob& job, const LaminateSetting& setting, const Target& target,
                              const LaminateDesign& design) {
    io::LayerSequence sequence;
    sequence.name = target.name;
    sequence.source = "voxtone laminate search " + target.file;
    if (setting.resins()) sequence.resins = job.setting.resins;
    sequence.surface = setting.surface_name();
    sequence.backing = setting.backing_name();
    for (const auto& [material, mm] : design.layers) sequence.layers.push_back({setting.names()[material], mm});
    return sequence;
}

std::string drawing(const LaminateSetting& setting, const Target& target, const LaminateDesign& design) {
    std::vector<ProfileCurve> curves{{"wanted", "black", target.wanted, false},
                                     {"layers", "#2266dd", design.modelled, true}};
    if (!design.judged.empty()) curves.push_back({"all directions", "#cc2222", design.judged, true});
    return profile_plots(setting.grid(), setting.channel_names(), {{target.name, std::move(curves)}}, 6);
}

// Mean of all coefficients over the first: smaller where light spreads wider.
double spread(const std::vector<double>& coefficients) {
    double sum = 0;
    for (const double value : coefficients) sum += value;
    return coefficients[0] != 0 ? sum / (static_cast<double>(coefficients.size()) * coefficients[0]) : 0;
}

void add_channel(io::JsonWriter& json, const LaminateSetting& setting, const Target& target,
                 const LaminateDesign& design, std::size_t c) {
    const auto add_figures = [&](const char* name, const std::vector<double>& R) {
        json.key(name).begin_object().add("total", R[0]).add("spread", spread(R)).end_object();
    };
    const ChannelMatch& match = design.found.channels[c];
    json.begin_object().add("channel", setting.channel_name(c));
    add_figures("target", target.wanted[c]);
    add_figures("layers", design.modelled[c]);
    if (!design.judged.empty()) add_figures("all_directions", design.judged[c]);
    json.add("reachable_totals_within", std::array{match.least_total, match.most_total}).end_object();
}

void add_result(io::JsonWriter& json, const LaminateSetting& setting, const Target& target,
                const LaminateDesign& design, const io::LayerSequence& sequence, const Times& times) {
    json.begin_object().add("target", target.file).key("layers").begin_list();
    for (const io::SequenceLayer& layer : sequence.layers)
        json.begin_object().add("material", layer.material).add("mm", layer.mm).end_object();
    json.end_list().add("distance", design.modelled_distance).add("outside_of_gamut", design.outside);
    json.key("channels").begin_list();
    for (std::size_t c = 0; c < target.wanted.size(); ++c) add_channel(json, setting, target, design, c);
    json.end_list().add("visited", design.found.count.visited).add("pruned", design.found.count.pruned);
    json.add("ms", times.search_ms);
    if (!design.judged.empty()) {
        json.add("all_directions_distance", design.judged_distance);
        json.add("all_directions_distances", design.judged_distances).add("all_directions_ms", times.judge_ms);
    }
    json.end_object();
}

std::string result_text(const LaminateSetting& setting, const Target& target, const LaminateDesign& design,
                        const io::LayerSequence& sequence, const Times& times) {
    double mm = 0;
    for (const io::SequenceLayer& layer : sequence.layers) mm += layer.mm;
    std::string text =
        fmt::format("{}: {}\n", target.name,
                    sequence.layers.empty()
                        ? std::string("no layer at all: the backing alone is nearest")
                        : fmt::format("{} mm, top first ({:.4g} mm in all)", io::layers_text(sequence.layers), mm));
    const std::string judged =
        design.judged.empty() ? std::string() : fmt::format(", in all directions {:.4f}", design.judged_distance);
    const std::string gamut = design.outside > 0
                                  ? fmt::format("outside of the gamut by at least {:.4f}{}", design.outside,
                                                setting.turned_back() > 0 ? " behind the surface" : "")
                                  : std::string("not known to lie outside of the gamut");
    text += fmt::format("  distance {:.4f}{}; {}\n", design.modelled_distance, judged, gamut);
    for (std::size_t c = 0; c < target.wanted.size(); ++c) {
        text += fmt::format("  {}: wanted {:.4f}, spread {:.4f}; layers {:.4f}, {:.4f}", setting.channel_name(c),
                            target.wanted[c][0], spread(target.wanted[c]), design.modelled[c][0],
                            spread(design.modelled[c]));
        if (!design.judged.empty())
            text += fmt::format("; all directions {:.4f}, {:.4f}", design.judged[c][0], spread(design.judged[c]));
        text += '\n';
    }
    text += fmt::format("  {} nodes visited, {} pruned, {} laminates compared; {:.0f} ms", design.found.count.visited,
                        design.found.count.pruned, design.found.count.judged, times.search_ms);
    if (!design.judged.empty())
        text += fmt::format(", and {:.1f} s of all directions for {} laminates", times.judge_ms / 1000,
                            design.judged_distances.size());
    return text + '\n';
}

/// What the backing reflects through the surface, without a layer between them.
ChannelProfiles bare_backing(const LaminateSetting& setting) {
    ChannelProfiles R = setting.backing_reflection();
    if (R.empty()) R.assign(setting.channels().size(), std::vector<double>(setting.grid().size(), 0.0));
    const double s = setting.turned_back();
    for (auto& channel : R)
        for (double& value : channel) value = (1 - s) * value / (1 - s * value);
    return R;
}

LaminateJudge judge_of(const LaminateSearchJob& job, const LaminateSetting& setting) {
    if (!setting.traceable() || job.rounds == 0) return {};
    constexpr double unit_mm = 0.001;
    const auto waves = std::make_shared<const optics::WaveLaminates>(*setting.resins(), setting.ends(), setting.grid(),
                                                                     optics::WaveOptions{4, 4, 4, unit_mm});
    return [&setting, waves](std::span<const LaminateLayer> layers) -> ChannelProfiles {
        return layers.empty() ? bare_backing(setting) : waves->light(setting.resin_layers(layers)).R;
    };
}

LaminateDesignOptions design_options(const LaminateSearchJob& job, const LaminateSetting& setting) {
    LaminateDesignOptions options;
    options.search.thickness_mm = job.thickness_mm;
    options.search.steps = job.steps;
    options.search.max_blocks = job.max_blocks;
    options.search.dc_weight = job.dc_weight;
    options.search.edge_weights = job.edge;
    options.search.clear_top_mm = clear_top(job, setting.names());
    options.search.backing = setting.backing_reflection();
    options.refine = job.refine;
    options.turned_back = setting.turned_back();
    options.layer_mm = job.layer_mm;
    options.rounds = std::max(1, job.rounds);
    return options;
}

/// The same judge, which adds up how long it takes.
LaminateJudge timed(const LaminateJudge& judge, double& ms) {
    if (!judge) return {};
    return [&judge, &ms](std::span<const LaminateLayer> layers) {
        const Stopwatch watch;
        ChannelProfiles R = judge(layers);
        ms += 1000 * watch.total();
        return R;
    };
}

}  // namespace

JobResult run_laminate_search(const LaminateSearchJob& job, Progress& progress) {
    check(job);
    const LaminateSetting setting(job.setting);
    const LaminateDesignOptions options = design_options(job, setting);
    const std::vector<Target> targets = read_targets(job, setting, progress);
    const fs::path out = output_folder(job, targets);
    const std::vector<LaminateMaterial> materials =
        setting.materials(job.known_mm, job.thickness_mm, {job.paths, job.seed}, progress);
    const LaminateSearch search(materials, options.search);
    const LaminateJudge judge = judge_of(job, setting);

    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-laminate-search").add("version", 1).add("folder", job.out);
    json.add("surface", setting.surface_name()).add("backing", setting.backing_name());
    json.add("laminates", search.laminates()).key("results").begin_list();
    std::string text;
    progress.begin_stage("Search", targets.size(), "targets");
    for (const Target& target : targets) {
        progress.check_cancelled();
        const Stopwatch watch;
        Times times;
        const LaminateDesign design =
            design_laminate(search, materials, target.wanted, options, timed(judge, times.judge_ms));
        times.search_ms = 1000 * watch.total() - times.judge_ms;
        const io::LayerSequence sequence = sequence_of(job, setting, target, design);
        io::write_whole_file(out / (target.name + ".laminate.json"), io::layer_sequence_text(sequence));
        io::write_whole_file(out / (target.name + ".svg"), drawing(setting, target, design));
        add_result(json, setting, target, design, sequence, times);
        text += result_text(setting, target, design, sequence, times);
        progress.advance();
    }
    progress.end_stage();
    json.end_list().end_object();
    return {json.text(), text};
}

}  // namespace voxtone::scattering

// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/jobs/laminate_targets_job.h"

#include <filesystem>

#include <fmt/format.h>

#include "base/error.h"
#include "base/warning.h"
#include "io/disk/output_files.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "scattering/design/widening_targets.h"
#include "scattering/jobs/profile_plots.h"
#include "scattering/jobs/spread_figures.h"

namespace voxtone::scattering {
namespace {

namespace fs = std::filesystem;

void check(const LaminateTargetsJob& job) {
    if (job.count < 1 || job.count > 1000)
        throw UsageError(fmt::format("--count: {}; it lies between 1 and 1000", job.count));
    check_paths(job.paths);
}

ChannelProfiles reflection(const NamedLaminate& laminate, const LaminateTargetsJob& job, Progress& progress) {
    const optics::LayerPathOptions tracing{job.paths, job.seed};
    ChannelProfiles R = layered_light(laminate, tracing, progress).R;
    for (std::size_t c = 0; c < R.size(); ++c)
        if (!(R[c][0] > 0))
            throw InputError(
                fmt::format("{}: reflects no light in channel {}, so there is no way in which it spreads; add a layer "
                            "that scatters",
                            laminate.sequence.name, laminate.setting.channel_name(c)));
    return R;
}

std::string target_json(const LaminateTargetsJob& job, const LaminateSetting& setting, std::size_t t,
                        const ChannelProfiles& R) {
    io::ProfileFile file;
    file.name = fmt::format("target {} of {}", t + 1, job.count);
    file.source =
        fmt::format("voxtone laminate targets: one albedo, from the width of {} to that of {}; surface {}, backing {}",
                    job.narrow, job.wide, setting.surface_name(), setting.backing_name());
    file.channels = setting.channels();
    for (const std::vector<double>& channel : R)
        file.by_channel.push_back({0, {}, profile_samples(setting.grid(), channel)});
    return io::profile_text(file);
}

std::string target_name(std::size_t t) { return fmt::format("target-{}.json", t + 1); }

constexpr const char* plots_name = "targets.svg";

fs::path output_folder(const LaminateTargetsJob& job) {
    std::vector<fs::path> names{plots_name};
    for (std::size_t t = 0; t < job.count; ++t) names.emplace_back(target_name(t));
    return io::make_folder_for(job.out, names, job.overwrite);
}

void check_comparable(const LaminateTargetsJob& job, const LaminateSetting& narrow, const LaminateSetting& wide) {
    if (narrow.channels() != wide.channels())
        throw InputError(
            fmt::format("{} and {}: their materials are of other channels; targets lie between laminates of the same",
                        job.narrow, job.wide));
    if (narrow.surface() != wide.surface())
        throw InputError(fmt::format(
            "{} and {}: one is under a surface to air and one is not; say which with --surface", job.narrow, job.wide));
}

void warn_of_narrowing(const LaminateTargetsJob& job, const LaminateSetting& setting, const ChannelProfiles& from,
                       const ChannelProfiles& to, Progress& progress) {
    for (std::size_t c = 0; c < from.size(); ++c)
        if (const double near = optics::radius_of_share(setting.grid(), from[c], 0.8),
            far = optics::radius_of_share(setting.grid(), to[c], 0.8);
            far < near)
            progress.warn(named_warning(
                "narrower-target",
                fmt::format("channel {}: light spreads less in {} (80 % within {:.2f} mm) than in {} ({:.2f} mm): the "
                            "targets get narrower there",
                            setting.channel_name(c), job.wide, far, job.narrow, near)));
}

void draw(const fs::path& file, const LaminateSetting& setting, const std::vector<ChannelProfiles>& targets) {
    std::vector<ProfileRow> rows;
    for (std::size_t t = 0; t < targets.size(); ++t)
        rows.push_back({fmt::format("{}", t + 1), {{"wanted", "black", targets[t], false}}});
    io::write_whole_file(file, profile_plots(setting.grid(), setting.channel_names(), rows, 6));
}

JobResult result_of(const LaminateTargetsJob& job, const LaminateSetting& setting,
                    const std::vector<ChannelProfiles>& targets) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-laminate-targets").add("version", 1).add("folder", job.out);
    json.key("targets").begin_list();
    std::string text;
    for (std::size_t t = 0; t < targets.size(); ++t) {
        const std::string file = (fs::path(job.out) / target_name(t)).string();
        text += file + '\n';
        json.begin_object().add("file", file).key("channels").begin_list();
        for (std::size_t c = 0; c < targets[t].size(); ++c) {
            const SpreadFigures figures = spread_figures(setting.grid(), targets[t][c]);
            json.begin_object().add("channel", setting.channel_name(c)).add("total", figures.total);
            json.add("half_within_mm", figures.half_mm).add("80_percent_within_mm", figures.most_mm).end_object();
            text += fmt::format("  {}: {}\n", setting.channel_name(c), spread_text('R', figures));
        }
        json.end_list().end_object();
    }
    json.end_list().end_object();
    return {json.text(), text};
}

}  // namespace

JobResult run_laminate_targets(const LaminateTargetsJob& job, Progress& progress) {
    check(job);
    const NamedLaminate narrow = read_named_laminate(job.narrow, job.setting),
                        wide = read_named_laminate(job.wide, job.setting);
    const LaminateSetting& setting = narrow.setting;
    check_comparable(job, setting, wide.setting);
    const fs::path out = output_folder(job);
    progress.begin_stage("trace", 0);
    const ChannelProfiles from = reflection(narrow, job, progress), to = reflection(wide, job, progress);
    progress.end_stage();
    warn_of_narrowing(job, setting, from, to, progress);
    const std::vector<ChannelProfiles> targets = widening_targets(from, to, job.count);
    for (std::size_t t = 0; t < targets.size(); ++t)
        io::write_whole_file(out / target_name(t), target_json(job, setting, t, targets[t]));
    draw(out / plots_name, setting, targets);
    return result_of(job, setting, targets);
}

}  // namespace voxtone::scattering

// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/stacks/stack_targets_job.h"

#include <filesystem>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "voxtone/base/error.h"
#include "voxtone/halftone/stacks/widening_targets.h"
#include "voxtone/io/files/whole_file.h"
#include "voxtone/slicer/stacks/profile_plots.h"

namespace voxtone::slicer {
namespace {

namespace fs = std::filesystem;
using halftone::ChannelProfiles;

void check(const StackTargetsJob& job) {
    if (job.count < 1 || job.count > 1000)
        throw UsageError(fmt::format("--count: {}; it lies between 1 and 1000", job.count));
    if (job.paths < 2) throw UsageError(fmt::format("--paths: {}; at least 2 are needed", job.paths));
}

ChannelProfiles reflection(const NamedStack& stack, const StackTargetsJob& job, Progress& progress) {
    const optics::LayerPathOptions tracing{job.paths, job.seed};
    ChannelProfiles R =
        (stack.setting.traceable() ? traced_light(stack, tracing, progress) : layered_light(stack, tracing, progress))
            .R;
    for (std::size_t c = 0; c < R.size(); ++c)
        if (!(R[c][0] > 0))
            throw InputError(
                fmt::format("{}: reflects no light in channel {}, so there is no way in which it spreads; add a layer "
                            "that scatters",
                            stack.sequence.name, stack.setting.channel_name(c)));
    return R;
}

std::string target_json(const StackTargetsJob& job, const StackSetting& setting, std::size_t t,
                        const ChannelProfiles& R) {
    io::ProfileFile file;
    file.name = fmt::format("target {} of {}", t + 1, job.count);
    file.source =
        fmt::format("voxtone stack targets: one albedo, from the width of {} to that of {}; surface {}, backing {}",
                    job.narrow, job.wide, setting.surface(), setting.backing());
    file.channels = setting.channels();
    for (const std::vector<double>& channel : R)
        file.by_channel.push_back({0, {}, profile_samples(setting.grid(), channel)});
    return io::profile_text(file);
}

fs::path output_folder(const StackTargetsJob& job) {
    std::error_code error;
    fs::create_directories(job.out, error);
    if (error) throw FileError(fmt::format("{}: the folder cannot be made: {}", job.out, error.message()));
    for (std::uint32_t t = 1; t <= job.count; ++t)
        if (const fs::path file = fs::path(job.out) / fmt::format("target-{}.json", t);
            !job.overwrite && fs::exists(file))
            throw InputError(fmt::format("{}: is there already; give another folder, or --overwrite", file.string()));
    return job.out;
}

}  // namespace

StackJobResult run_stack_targets(const StackTargetsJob& job, Progress& progress) {
    check(job);
    const NamedStack narrow = read_named_stack(job.narrow, job.stack), wide = read_named_stack(job.wide, job.stack);
    const StackSetting& setting = narrow.setting;
    if (setting.channels() != wide.setting.channels())
        throw InputError(
            fmt::format("{} and {}: their materials are of other channels; targets lie between stacks of the same",
                        job.narrow, job.wide));
    if (setting.surface() != wide.setting.surface())
        throw InputError(fmt::format(
            "{} and {}: one is under a surface to air and one is not; say which with --surface", job.narrow, job.wide));
    const fs::path out = output_folder(job);
    progress.begin_stage("trace", 0);
    const ChannelProfiles from = reflection(narrow, job, progress), to = reflection(wide, job, progress);
    progress.end_stage();
    for (std::size_t c = 0; c < from.size(); ++c)
        if (const double near = optics::radius_of_share(setting.grid(), from[c], 0.8),
            far = optics::radius_of_share(setting.grid(), to[c], 0.8);
            far < near)
            progress.warn(
                fmt::format("channel {}: light spreads less in {} (80 % within {:.2f} mm) than in {} ({:.2f} mm): the "
                            "targets get narrower there",
                            setting.channel_name(c), job.wide, far, job.narrow, near));
    const std::vector<ChannelProfiles> targets = halftone::widening_targets(from, to, job.count);

    nlohmann::ordered_json files = nlohmann::json::array();
    std::string text;
    std::vector<ProfileRow> rows;
    const optics::HankelGrid& grid = setting.grid();
    for (std::size_t t = 0; t < targets.size(); ++t) {
        const fs::path file = out / fmt::format("target-{}.json", t + 1);
        io::write_whole_file(file, target_json(job, setting, t, targets[t]));
        text += file.string() + '\n';
        nlohmann::ordered_json channels = nlohmann::json::array();
        for (std::size_t c = 0; c < targets[t].size(); ++c) {
            const std::vector<double>& R = targets[t][c];
            const double half = optics::radius_of_share(grid, R, 0.5), most = optics::radius_of_share(grid, R, 0.8);
            channels.push_back({{"channel", setting.channel_name(c)},
                                {"total", R[0]},
                                {"half_within_mm", half},
                                {"80_percent_within_mm", most}});
            text += fmt::format("  {}: R {:.4f}, half of it within {:.2f} mm, 80 % within {:.2f} mm\n",
                                setting.channel_name(c), R[0], half, most);
        }
        files.push_back({{"file", file.string()}, {"channels", channels}});
        rows.push_back({fmt::format("{}", t + 1), {{"wanted", "black", targets[t], false}}});
    }
    std::vector<std::string> names;
    for (std::size_t c = 0; c < setting.channels().size(); ++c) names.push_back(setting.channel_name(c));
    io::write_whole_file(out / "targets.svg", profile_plots(grid, names, rows, 6));
    const nlohmann::ordered_json json{
        {"format", "voxtone-stack-targets"}, {"version", 1}, {"folder", job.out}, {"targets", files}};
    return {json.dump(), text};
}

}  // namespace voxtone::slicer

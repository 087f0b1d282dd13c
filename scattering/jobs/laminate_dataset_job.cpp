// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/jobs/laminate_dataset_job.h"

#include <array>
#include <numeric>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/stopwatch.h"
#include "io/disk/disk_space.h"
#include "io/disk/output_files.h"
#include "io/files/json_writer.h"
#include "io/profiles/bssrdf_file.h"
#include "io/profiles/resin_file.h"
#include "optics/monte_carlo/sampled_bssrdf.h"

namespace voxtone::scattering {
namespace {

/// Columns beyond the window at every side, so that the outermost points see the pattern go on.
constexpr std::uint32_t beyond_window = 4;

optics::SlabOptions slab_of(const LaminateDatasetJob& job) {
    optics::SlabOptions slab = job.slab;
    slab.margin = job.radius + beyond_window;
    return slab;
}

optics::SampledBssrdfOptions tracing_of(const LaminateDatasetJob& job) {
    return {job.slab.width, job.slab.height, job.radius + beyond_window,
            job.radius,     job.paths,       job.path_seed.value_or(job.slab.seed)};
}

optics::ResinSet resins_of(const LaminateDatasetJob& job) {
    optics::ResinSet set = io::find_resin_set(job.resins);
    if (job.matched) {
        set.eta = 1;
        for (optics::Resin& resin : set.resins) resin.eta.reset();
    }
    return set;
}

std::string_view pattern_name(optics::SlabPattern pattern) {
    for (const auto& [name, value] : slab_pattern_names)
        if (value == pattern) return name;
    return "";
}

/// Of the file. Throws InputError where it would be too large.
std::uint64_t bytes_of(const LaminateDatasetJob& job, std::size_t channels) {
    const std::uint64_t bytes = io::bssrdf_bytes(channels, job.slab.width, job.slab.height, job.radius);
    if (bytes > io::most_bssrdf_bytes)
        throw InputError(
            fmt::format("{} x {} points, radius {}, {} channels make a file of {:.1f} GB, more than the {:.1f} GB that "
                        "one may have; take fewer --points or a smaller --radius.",
                        job.slab.width, job.slab.height, job.radius, channels, 1e-9 * static_cast<double>(bytes),
                        1e-9 * static_cast<double>(io::most_bssrdf_bytes)));
    return bytes;
}

std::string source_of(const LaminateDatasetJob& job, const optics::ResinSet& set) {
    return fmt::format(
        "voxtone laminate dataset {}: {}, {} mm thick on black, pattern of {} mm, seed {}, {} paths a point{}",
        pattern_name(job.slab.pattern), set.name, job.slab.thickness_mm, job.slab.feature_mm, job.slab.seed, job.paths,
        job.matched ? ", no refractive surface" : "");
}

optics::SampledBssrdf trace(const LaminateDatasetJob& job, const optics::ResinSet& set, Progress& progress) {
    const optics::MixtureSlab slab = optics::make_slab(set, slab_of(job));
    progress.begin_stage("trace", set.channels.size() * std::uint64_t{job.slab.width} * job.slab.height, "points");
    optics::SampledBssrdf responses = optics::trace_bssrdf(
        {&slab.volume, &slab.mixtures, optics::Backing::black, optics::Sides::mirrored}, tracing_of(job), &progress);
    progress.end_stage();
    return responses;
}

/// Mean over the points, of each channel.
std::vector<double> mean_albedo(const optics::SampledBssrdf& responses) {
    std::vector<double> albedo;
    for (const auto& channel : responses.channels)
        albedo.push_back(std::accumulate(channel.total.begin(), channel.total.end(), 0.0) /
                         static_cast<double>(channel.total.size()));
    return albedo;
}

std::vector<double> beyond_windows(const optics::SampledBssrdf& responses) {
    std::vector<double> beyond;
    for (std::size_t c = 0; c < responses.channels.size(); ++c)
        beyond.push_back(optics::share_beyond_window(responses, c));
    return beyond;
}

JobResult result_of(const LaminateDatasetJob& job, const optics::SampledBssrdf& responses, std::uint64_t bytes,
                    double seconds) {
    const std::vector<double> albedo = mean_albedo(responses), beyond = beyond_windows(responses);
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-laminate-dataset").add("version", 1).add("dataset", job.out);
    json.add("points", std::array{job.slab.width, job.slab.height}).add("bytes", bytes).add("mean_albedo", albedo);
    json.add("beyond_window", beyond).add("seconds", seconds).end_object();
    return {json.text(),
            fmt::format("{}: {} x {} points at {} mm, {:.1f} MB; mean albedo {:.3f}; share of light beyond {:.3g} mm "
                        "{:.4f} (by channel); {} paths a point and channel in {:.1f} s\n",
                        job.out, job.slab.width, job.slab.height, job.slab.pitch_mm, 1e-6 * static_cast<double>(bytes),
                        fmt::join(albedo, ", "), job.radius * job.slab.pitch_mm, fmt::join(beyond, ", "), job.paths,
                        seconds)};
}

}  // namespace

void LaminateDatasetJob::validate() const {
    if (radius < 1 || radius > 64)
        throw InputError(fmt::format("The radius of a window is {} points, expected 1 to 64.", radius));
    if (paths < 1 || paths > 1u << 24)
        throw InputError(fmt::format("There are to be {} paths a point, expected 1 to {}.", paths, 1u << 24));
}

JobResult run_laminate_dataset(const LaminateDatasetJob& job, Progress& progress) {
    job.validate();
    const optics::ResinSet set = resins_of(job);
    const std::uint64_t bytes = bytes_of(job, set.channels.size());
    io::expect_outputs({job.out}, job.overwrite);
    io::expect_disk_space(job.out, bytes, "the data set");
    progress.note(fmt::format("the data set will take {:.1f} MB", 1e-6 * static_cast<double>(bytes)));
    const Stopwatch watch;
    io::BssrdfFile data;
    data.channels = set.channels;
    data.responses = trace(job, set, progress);
    const double seconds = watch.total();
    data.source = source_of(job, set);
    io::write_bssrdf(data, job.out);
    return result_of(job, data.responses, bytes, seconds);
}

}  // namespace voxtone::scattering

// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/jobs/laminate_trace_job.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "base/warning.h"
#include "io/disk/output_files.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "io/profiles/bssrdf_file.h"
#include "optics/colour/channels.h"
#include "scattering/design/laminate_search.h"
#include "scattering/jobs/layered_options.h"
#include "scattering/jobs/place_profiles.h"
#include "scattering/jobs/profile_map_picture.h"
#include "scattering/jobs/profile_plots.h"
#include "scattering/jobs/spread_figures.h"
#include "scattering/local_profiles/luminance_channel.h"
#include "slicer/options/job_file.h"
#include "slicer/options/resolve_job.h"
#include "slicer/predict/stack_volume.h"

namespace voxtone::scattering {
namespace {

namespace fs = std::filesystem;

/// How unlike the map's a print's size may be.
constexpr double as_large = 0.02;

void check(const LaminateTraceJob& job) {
    if (job.paths < 1 || job.paths > 1u << 24)
        throw UsageError(fmt::format("--paths: {}; it lies between 1 and {}", job.paths, 1u << 24));
    for (const std::string& file : job.files) {
        const std::string ending = fs::path(file).extension().string();
        if (ending != ".png" && ending != ".svg" && ending != ".bssrdf")
            throw UsageError(fmt::format("{}: what was traced is written as .png, .svg or .bssrdf", file));
    }
}

LayeredOptions options_of(const LaminateTraceJob& job) {
    const fs::path file = fs::path(job.stack) / slicer::job_file_name;
    std::error_code none;
    std::optional<LayeredOptions> layered;
    if (fs::exists(file, none)) {
        slicer::SliceOptions requested;
        slicer::read_job(file.string(), requested);
        const slicer::ResolvedJob resolved = slicer::resolve(requested);
        if (const LayeredOptions* options = layered_options(resolved)) layered = *options;
    }
    if (!layered)
        throw InputError(fmt::format(
            "{}: there is no {} that says `--show layered-profile`, so no map says how light is to spread in it; other "
            "prints are seen by `voxtone predict`",
            job.stack, file.string()));
    if (!job.profiles.empty()) layered->profiles = job.profiles;
    return *layered;
}

/// One way to know the surface.
struct Column {
    std::string name, colour;
    std::vector<std::vector<PlaceProfile>> of_cluster;  ///< by channel; empty where a cluster has no place
    PictureColumn picture;
};

/// A cluster that has places to look at.
struct Place {
    std::size_t cluster = 0, points = 0;
    double share = 0;  ///< of these places
    double noise = 0;
    std::vector<double> off;  ///< of each column from the first
    double off_map = 0;       ///< of what is printed from the map
};

struct Traced {
    io::ProfileMap map;
    optics::HankelGrid grid;
    std::vector<Column> columns;  ///< the map and the print last
    std::vector<Place> places;    ///< the largest first
    double pitch_mm = 0, seconds = 0, scale = 1;
    double extent_mm = 0;  ///< of the profiles
    double left_out = 0;   ///< share of the map whose clusters lie by its border alone
    PointGrid points = {};
    std::uint32_t radius = 0;  ///< of windows, points
    std::size_t drawn = 0;     ///< the point whose response is
    optics::SampledBssrdf printed = {};
    [[nodiscard]] const Column& of_map() const { return columns[columns.size() - 2]; }
};

/// A slab as large as its map, with resin all over its top.
void check_slab(const LaminateTraceJob& job, const io::ProfileMap& map, const slicer::StackVolume& stack) {
    if (!stack.of_picture)
        throw InputError(fmt::format(
            "{}: is a body; R(r) is traced on a slab, where distances are those of the map: slice the map's picture "
            "with the same options",
            job.stack));
    if (stack.resins.channels != map.channels)
        throw InputError(
            fmt::format("{}: its resins are for {}, the map's profiles for {}; choose the --resins that it "
                        "was made with",
                        job.stack, optics::channels_text(stack.resins.channels), optics::channels_text(map.channels)));
    const double pixel[2] = {map.width_mm / map.width_px, map.height_mm / map.height_px};
    const double wanted[2] = {map.width_mm, map.height_mm};
    if (std::abs(pixel[0] / pixel[1] - 1) > as_large)
        throw InputError(
            fmt::format("the map's pixels are {:.3g} x {:.3g} mm; R(r) is compared on squares", pixel[0], pixel[1]));
    const auto& size = stack.volume.size();
    for (std::size_t a = 0; a < 2; ++a) {
        const double mm = 2 * stack.corner_mm[a] + size[a] * stack.volume.pitch_mm()[a];
        if (std::abs(mm / wanted[a] - 1) > as_large)
            throw InputError(fmt::format(
                "{}: is {:.4g} mm along {}, its map {:.4g} mm; profiles are in mm whatever the size, so that they can "
                "only be compared on a print of the map's own size",
                job.stack, mm, "xy"[a], wanted[a]));
    }
    std::vector<optics::Material> top(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]));
    stack.volume.copy_box({0, 0, size[2] - 1}, {size[0], size[1], 1}, top);
    if (std::find(top.begin(), top.end(), optics::air) != top.end())
        throw InputError(
            fmt::format("{}: its top is not flat resin all over (cut out?), where light is to enter", job.stack));
}

optics::SampledBssrdf trace(const LaminateTraceJob& job, const io::ProfileMap& map, const slicer::StackVolume& stack,
                            std::uint32_t radius, Progress& progress) {
    optics::SampledBssrdfOptions options{map.width_px, map.height_px, 0, radius, job.paths, job.seed};
    const auto& pitch = stack.volume.pitch_mm();
    for (std::size_t a = 0; a < 2; ++a) {
        const double mm = 2 * stack.corner_mm[a] + stack.volume.size()[a] * pitch[a];
        options.columns[a] = mm / (a == 0 ? map.width_px : map.height_px) / pitch[a];
        options.first[a] = -stack.corner_mm[a] / pitch[a];
    }
    progress.begin_stage("trace", map.channels.size() * std::uint64_t{map.width_px} * map.height_px, "places");
    const optics::Scene scene{&stack.volume, &stack.resins,
                              stack.backing ? stack.backing->kind : optics::Backing::none};
    optics::SampledBssrdf printed = optics::trace_bssrdf(scene, options, &progress);
    progress.end_stage();
    return printed;
}

/// The data in the map's scale: `laminate factor --max-albedo` may have made its profiles darker.
double scale_to(const LocalProfiles& of_map, optics::SampledBssrdf& data) {
    double wanted = 0, there = 0;
    for (std::size_t c = 0; c < data.channels.size(); ++c) {
        for (const double albedo : spread_of(of_map, c).albedo) wanted += albedo;
        for (const double albedo : spread_of(data, c).albedo) there += albedo;
    }
    const double scale = there > 0 ? wanted / there : 1;
    for (optics::ChannelResponses& channel : data.channels) {
        channel.noise *= scale;
        for (auto* values : {&channel.pairs, &channel.total})
            for (float& value : *values) value *= static_cast<float>(scale);
    }
    return scale;
}

io::BssrdfFile read_data(const LaminateTraceJob& job, const io::ProfileMap& map, const LocalProfiles& of_map) {
    io::BssrdfFile file = io::read_bssrdf(job.dataset);
    if (is_luminance(map.channels) && file.channels.size() > 1) file = luminance_of(file);
    const optics::SampledBssrdf& data = file.responses;
    if (data.width != map.width_px || data.height != map.height_px || data.radius != of_map.radius ||
        file.channels != map.channels || std::abs(data.pitch_mm / of_map.pitch_mm - 1) > 1e-6)
        throw InputError(fmt::format(
            "{}: has {} x {} points of {:g} mm, radius {}, for {}; the map {} x {} of {:g} mm, radius {}, for {}: it "
            "is not the data set that the map was made from",
            job.dataset, data.width, data.height, data.pitch_mm, data.radius, optics::channels_text(file.channels),
            map.width_px, map.height_px, of_map.pitch_mm, of_map.radius, optics::channels_text(map.channels)));
    return file;
}

template <class Source>
Column column_of(const char* name, const char* colour, const Source& source,
                 const std::vector<std::vector<std::size_t>>& points, std::size_t drawn) {
    Column column{name, colour, {}, picture_column(source, source.channels.size(), drawn)};
    for (const auto& of_cluster : points)
        column.of_cluster.push_back(of_cluster.empty() ? std::vector<PlaceProfile>()
                                                       : place_profiles(source, of_cluster));
    return column;
}

ChannelProfiles coefficients_of(const Traced& traced, const Column& column, std::size_t cluster) {
    ChannelProfiles profiles;
    for (const PlaceProfile& channel : column.of_cluster[cluster])
        profiles.push_back(channel.coefficients(traced.grid, traced.pitch_mm));
    return profiles;
}

void judge(Traced& traced, const std::vector<std::vector<std::size_t>>& points, const optics::SampledBssrdf& printed) {
    std::size_t all = 0, kept = 0;
    std::vector<std::size_t> pixels(points.size());
    for (const std::uint16_t cluster : traced.map.cluster) ++pixels[cluster];
    for (std::size_t k = 0; k < points.size(); ++k) {
        all += points[k].size();
        if (!points[k].empty()) kept += pixels[k];
    }
    traced.left_out = 1 - static_cast<double>(kept) / static_cast<double>(traced.map.cluster.size());
    for (std::size_t k = 0; k < points.size(); ++k) {
        if (points[k].empty()) continue;
        Place& place = traced.places.emplace_back();
        place.cluster = k;
        place.points = points[k].size();
        place.share = static_cast<double>(points[k].size()) / static_cast<double>(all);
        place.noise = noise_of(printed, traced.columns.back().of_cluster[k], points[k].size());
        const ChannelProfiles first = coefficients_of(traced, traced.columns[0], k),
                              print = coefficients_of(traced, traced.columns.back(), k);
        for (const Column& column : traced.columns)
            place.off.push_back(profile_distance(coefficients_of(traced, column, k), first, 1));
        place.off_map = profile_distance(print, coefficients_of(traced, traced.of_map(), k), 1);
    }
    std::stable_sort(traced.places.begin(), traced.places.end(),
                     [](const Place& a, const Place& b) { return a.points > b.points; });
}

/// Mean over the places of the map.
template <class Of>
double by_area(const Traced& traced, Of&& of) {
    double sum = 0;
    for (const Place& place : traced.places) sum += place.share * of(place);
    return sum;
}

void add_column(io::JsonWriter& json, const Traced& traced, const Column& column, std::size_t cluster) {
    json.key(column.name.c_str()).begin_list();
    for (const PlaceProfile& channel : column.of_cluster[cluster]) {
        const SpreadFigures figures = spread_figures(traced.grid, channel.coefficients(traced.grid, traced.pitch_mm));
        json.begin_object().add("total", figures.total).add("beyond", channel.beyond);
        json.add("half_within_mm", figures.half_mm).add("per_mm2", channel.per_mm2).end_object();
    }
    json.end_list();
}

std::string result_json(const LaminateTraceJob& job, const Traced& traced) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-laminate-trace").add("version", 1).add("stack", job.stack);
    json.add("paths", job.paths).add("seconds", traced.seconds).add("spacing_mm", traced.pitch_mm);
    json.add("scale", traced.scale).add("left_out", traced.left_out).key("clusters").begin_list();
    for (const Place& place : traced.places) {
        json.begin_object().add("cluster", place.cluster).add("share", place.share).add("places", place.points);
        json.add("distance", place.off_map).add("noise", place.noise);
        for (const Column& column : traced.columns) add_column(json, traced, column, place.cluster);
        json.key("distance_from_first").begin_object();
        for (std::size_t i = 1; i < traced.columns.size(); ++i) json.add(traced.columns[i].name.c_str(), place.off[i]);
        json.end_object().end_object();
    }
    json.end_list().add("distance", by_area(traced, [](const Place& p) { return p.off_map; }));
    json.add("noise", by_area(traced, [](const Place& p) { return p.noise; }));
    json.key("distance_from_first").begin_object();
    for (std::size_t i = 1; i < traced.columns.size(); ++i)
        json.add(traced.columns[i].name.c_str(), by_area(traced, [&](const Place& p) { return p.off[i]; }));
    return json.end_object().end_object().text();
}

constexpr std::size_t most_listed = 16;

/// R of the channel in the middle and the mm that half of it leaves within, of each column; the largest clusters alone.
std::vector<std::vector<std::string>> table_rows(const Traced& traced) {
    const std::size_t channel = traced.map.channels.size() / 2;
    std::vector<std::vector<std::string>> rows;
    for (std::size_t i = 0; i < std::min(most_listed, traced.places.size()); ++i) {
        const Place& place = traced.places[i];
        std::vector<std::string>& row = rows.emplace_back();
        row = {fmt::format("{}", place.cluster), fmt::format("{:.1f} %", 100 * place.share),
               fmt::format("{}", place.points)};
        std::vector<std::string> half;
        for (const Column& column : traced.columns) {
            const SpreadFigures figures = spread_figures(
                traced.grid, column.of_cluster[place.cluster][channel].coefficients(traced.grid, traced.pitch_mm));
            row.push_back(fmt::format("{:.4f}", figures.total));
            half.push_back(fmt::format("{:.2f}", figures.half_mm));
        }
        row.insert(row.end(), half.begin(), half.end());
        row.push_back(fmt::format("{:.4f}", place.off_map));
        row.push_back(fmt::format("{:.4f}", place.noise));
    }
    return rows;
}

std::string table_text(const Traced& traced) {
    std::string names;
    for (const Column& column : traced.columns) names += fmt::format(" {:>9}", column.name);
    std::string text = fmt::format("  cluster   share  places {} |{}  distance   noise\n", names, names);
    for (const std::vector<std::string>& row : table_rows(traced)) {
        text += fmt::format("  {:>7} {:>7} {:>7} ", row[0], row[1], row[2]);
        const std::size_t half = 3 + traced.columns.size();
        for (std::size_t k = 3; k + 2 < row.size(); ++k) text += fmt::format("{} {:>9}", k == half ? " |" : "", row[k]);
        text += fmt::format("  {:>8}  {:>6}\n", row[row.size() - 2], row.back());
    }
    if (traced.places.size() > most_listed)
        text += fmt::format("  and {} smaller clusters\n", traced.places.size() - most_listed);
    return text;
}

std::vector<std::string> table_header(const Traced& traced) {
    std::vector<std::string> header{"cluster", "share", "places"};
    for (const char* what : {"R", "half within, mm"})
        for (const Column& column : traced.columns) header.push_back(fmt::format("{}: {}", column.name, what));
    header.insert(header.end(), {"distance", "noise"});
    return header;
}

/// What was traced, and what the table's columns are.
std::string heading_of(const LaminateTraceJob& job, const Traced& traced) {
    return fmt::format(
        "{} x {} places of {:.3g} mm, {} paths each and channel, traced in {:.1f} s; {}: R | the mm that half of it "
        "leaves within",
        traced.map.width_px, traced.map.height_px, traced.pitch_mm, job.paths, traced.seconds,
        optics::channel_name(traced.map.channels, traced.map.channels.size() / 2));
}

std::string judged_text(const Traced& traced) {
    std::string text = table_text(traced);
    text += fmt::format("  by area: print {:.4f} from the map (rms over Hankel coefficients; noise {:.4f} at most)",
                        by_area(traced, [](const Place& p) { return p.off_map; }),
                        by_area(traced, [](const Place& p) { return p.noise; }));
    if (traced.columns.size() > 2) {
        text += fmt::format("; from what was {}:", traced.columns[0].name);
        for (std::size_t i = 1; i < traced.columns.size(); ++i)
            text += fmt::format("{} {} {:.4f}", i > 1 ? "," : "", traced.columns[i].name,
                                by_area(traced, [&](const Place& p) { return p.off[i]; }));
    }
    if (traced.left_out > 0)
        text += fmt::format("; {:.1f} % of the map is of clusters that lie by its border alone, left out",
                            100 * traced.left_out);
    return text + "\n";
}

std::string drawing(const Traced& traced) {
    constexpr std::size_t most_drawn = 9;
    std::vector<std::string> channels;
    for (std::size_t c = 0; c < traced.map.channels.size(); ++c)
        channels.push_back(optics::channel_name(traced.map.channels, c));
    std::vector<ProfileRow> rows;
    for (std::size_t i = 0; i < std::min(most_drawn, traced.places.size()); ++i) {
        const Place& place = traced.places[i];
        ProfileRow& row = rows.emplace_back();
        row.title = fmt::format("{}: {:.1f} %", place.cluster, 100 * place.share);
        for (const Column& column : traced.columns)
            row.curves.push_back({column.name, column.colour, coefficients_of(traced, column, place.cluster),
                                  &column == &traced.columns.back()});
    }
    return profile_plots(traced.grid, channels, rows, traced.extent_mm);
}

Traced trace_slab(const LaminateTraceJob& job, Progress& progress) {
    const LayeredOptions options = options_of(job);
    io::ProfileMap map = io::read_profile_map(options.profiles);
    LocalProfiles of_map = profiles_of_map(map);
    io::BssrdfFile asked;
    optics::SampledBssrdf& data = asked.responses;
    if (!job.dataset.empty()) asked = read_data(job, map, of_map);
    slicer::StackVolumeOptions reading;
    reading.stack = job.stack;
    reading.resins = job.resins;
    const slicer::StackVolume stack = slicer::read_stack_volume(reading, progress);
    map = asked_of(stack.resins.channels, std::move(map));
    asked = asked_of(stack.resins.channels, std::move(asked));
    of_map = profiles_of_map(map);
    check_slab(job, map, stack);

    // Waves from 0.3 mm on, the total no heavier than the rest.
    const double extent_mm = of_map.radius * of_map.pitch_mm;
    Traced traced{map, optics::HankelGrid(std::max(10.0, 1.5 * extent_mm), 64), {}, {}, of_map.pitch_mm};
    traced.extent_mm = extent_mm;
    traced.points = of_map.grid;
    traced.radius = of_map.radius;
    traced.drawn = middle_point(of_map.grid);
    const auto points = points_of_clusters(map, unjudged_margin(of_map.grid, of_map.radius));
    const auto add = [&](const char* name, const char* colour, const auto& source) {
        traced.columns.push_back(column_of(name, colour, source, points, traced.drawn));
    };
    if (!job.dataset.empty()) {
        traced.scale = scale_to(of_map, data);
        std::vector<FactorSummary> summary;
        add("asked", "black", data);
        add("factored", "#999999", factor_responses(data, {}, summary));
    }
    add("clustered", "#2266dd", of_map);
    const Stopwatch watch;
    traced.printed = trace(job, map, stack, of_map.radius, progress);
    traced.seconds = watch.total();
    add("printed", "#cc2222", traced.printed);
    judge(traced, points, traced.printed);
    return traced;
}

/// What is in the columns of the picture, and its rows.
std::string caption_of(const Traced& traced, const ComparisonPicture& picture) {
    std::string names;
    for (const Column& column : traced.columns) names += (names.empty() ? "" : ", ") + column.name;
    return fmt::format("columns {}; rows albedo, mean distance {:.2f} to {:.2f} mm, response of the middle", names,
                       picture.least_mm, picture.most_mm);
}

ComparisonPicture picture_of(const Traced& traced) {
    std::vector<PictureColumn> columns;
    for (const Column& column : traced.columns) columns.push_back(column.picture);
    return draw_columns(traced.map.channels, traced.points, traced.radius, traced.drawn, columns);
}

}  // namespace

SeenSpread seen_spread(const LaminateTraceJob& job, Progress& progress) {
    check(job);
    const Traced traced = trace_slab(job, progress);
    const ComparisonPicture picture = picture_of(traced);
    return {heading_of(job, traced),     table_header(traced),           table_rows(traced),
            caption_of(traced, picture), io::png_bytes(picture.picture), picture.picture.width_px,
            picture.picture.height_px};
}

JobResult run_laminate_trace(const LaminateTraceJob& job, Progress& progress) {
    check(job);
    io::expect_outputs({job.files.begin(), job.files.end()}, job.overwrite);
    const Traced traced = trace_slab(job, progress);
    std::string text = fmt::format("{}: {}\n{}", job.stack, heading_of(job, traced), judged_text(traced));
    for (const std::string& file : job.files) {
        if (fs::path(file).extension() == ".svg") {
            io::write_whole_file(file, drawing(traced));
        } else if (fs::path(file).extension() == ".bssrdf") {
            io::write_bssrdf({fmt::format("voxtone laminate trace {}: {} paths a place", job.stack, job.paths),
                              traced.map.channels, traced.printed},
                             file);
            text += fmt::format("  {}: R of the printed voxels\n", file);
        } else {
            const ComparisonPicture picture = picture_of(traced);
            io::write_whole_file(file, io::png_bytes(picture.picture));
            text += fmt::format("  {}: {}\n", file, caption_of(traced, picture));
        }
    }
    return {result_json(job, traced), text};
}

}  // namespace voxtone::scattering

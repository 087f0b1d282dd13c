// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/print/layers_report.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numeric>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "io/files/whole_file.h"
#include "io/models/ply_writer.h"
#include "io/pictures/picture_writer.h"
#include "io/pictures/srgb_code.h"
#include "io/report/plot_svg.h"
#include "optics/colour/channels.h"
#include "scattering/jobs/laminate_trace_job.h"
#include "slicer/look/preview.h"
#include "slicer/look/report_views.h"
#include "slicer/look/viewer_surface.h"
#include "slicer/part/report_files.h"
#include "slicer/surface/target_cells.h"

namespace voxtone::scattering {

namespace {

/// Clusters that the map has, the most frequent first.
std::vector<std::size_t> by_share(const JobLayers& layers) {
    std::vector<std::size_t> order(layers.clusters.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::erase_if(order, [&](std::size_t c) { return layers.clusters[c].share == 0; });
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return layers.clusters[a].share > layers.clusters[b].share; });
    return order;
}

std::string laminate_text(const ClusterLaminate& cluster, const slicer::LoadedResins& resins) {
    std::string text;
    for (const LaminateLayer& layer : cluster.design.layers)
        text += fmt::format("{}{} {:.3f}", text.empty() ? "" : " / ", resins.entries[layer.material].role,
                            layer.thickness_mm);
    return text.empty() ? std::string("the base alone") : text;
}

/// Channels that are drawn: all of RGB, or the first, the middle and the last of others. A printer's own have no
/// order and no hue.
struct DrawnChannel {
    std::size_t index;
    const char* colour;
    std::string name;
};
std::vector<DrawnChannel> drawn_channels(const optics::Channels& channels) {
    constexpr const char *red = "#c62828", *green = "#2e7d32", *blue = "#1565c0", *violet = "#6a1b9a",
                         *brown = "#795548", *grey = "#546e7a";
    if (channels.is_rgb()) return {{0, red, "red"}, {1, green, "green"}, {2, blue, "blue"}};
    const std::size_t last = channels.size() - 1;
    std::vector<DrawnChannel> drawn;
    const bool own = channels.is_own();
    for (const auto& [index, colour] : {std::pair{std::size_t{0}, own ? violet : blue},
                                        std::pair{last / 2, own ? brown : green}, std::pair{last, own ? grey : red}})
        if (drawn.empty() || drawn.back().index != index)
            drawn.push_back({index, colour, optics::channel_name(channels, index)});
    return drawn;
}

io::ReportDrawing profile_drawing(const JobLayers& layers, std::size_t number, const slicer::LoadedResins& resins) {
    const ClusterLaminate& cluster = layers.clusters[number];
    const optics::HankelGrid& grid = layers.grid;
    const double most_mm = profile_extent_mm(layers.map), blur_mm = 1.5 * grid.reach_mm() / double(grid.size());
    constexpr int points = 120;
    const std::vector<DrawnChannel> channels = drawn_channels(layers.map.channels);
    const auto curve = [&](const std::vector<double>& coefficients) {
        io::Plot::Points line;
        const std::vector<double> seen = grid.blurred(coefficients, blur_mm);
        for (int i = 0; i <= points; ++i)
            line.emplace_back(most_mm * i / points, grid.profile(seen, most_mm * i / points));
        return line;
    };
    std::vector<std::array<io::Plot::Points, 2>> lines;
    double most = 0;
    for (const DrawnChannel& channel : channels) {
        lines.push_back({curve(cluster.target[channel.index]), curve(cluster.expected()[channel.index])});
        for (const io::Plot::Points& line : lines.back())
            for (const auto& point : line) most = std::max(most, point.second);
    }
    constexpr int decades = 5;
    const double top = std::pow(10.0, std::ceil(std::log10(std::max(most, 1e-9))));
    io::PlotAxis x{0, most_mm, false, {}, "distance, mm"},
        y{top * std::pow(10.0, -decades), top, true, {}, "light per mm2"};
    for (int i = 0; i <= 4; ++i) x.marks.push_back(most_mm * i / 4);
    for (int i = 0; i <= decades; ++i) y.marks.push_back(top * std::pow(10.0, -i));
    io::Plot plot(x, y, fmt::format("Cluster {}: {:.1f} % of the map", number, 100 * cluster.share));
    for (std::size_t c = 0; c < channels.size(); ++c) {
        plot.line(lines[c][0], channels[c].colour, 1.5, true);
        plot.line(lines[c][1], channels[c].colour);
    }
    return {fmt::format("{}; distance {:.4f}", laminate_text(cluster, resins), cluster.distance()), plot.svg()};
}

Eigen::Vector3f total_colour(const optics::Channels& channels, const ChannelProfiles& profiles) {
    Eigen::VectorXd totals(static_cast<Eigen::Index>(profiles.size()));
    for (std::size_t c = 0; c < profiles.size(); ++c) totals[static_cast<Eigen::Index>(c)] = profiles[c][0];
    return (optics::linear_srgb_weights(channels) * totals).cast<float>().cwiseMax(0.0f).cwiseMin(1.0f);
}

/// The surface in one colour for each cluster.
slicer::ColouredSurface by_cluster(const JobLayers& layers, const slicer::JobBody& body,
                                   std::vector<Eigen::Vector3f> colours) {
    slicer::ColouredSurface out;
    out.positions_mm = body.surface->positions_mm;
    out.triangles = body.surface->triangles;
    out.colour = [&layers, &body, colours = std::move(colours)](std::uint32_t t, float u, float v) {
        const auto& corner = body.surface->source_uv[t];
        const Eigen::Vector2f at = (1 - u - v) * corner[0] + u * corner[1] + v * corner[2];
        const Eigen::Vector2f place = layers.wrapped().map_point(t, at.x(), at.y());
        return colours[layers.wrapped().fields().laminate_at(place.x(), place.y())];
    };
    return out;
}

/// Roles are free words: what is no letter or digit becomes a line.
std::string surface_name(const io::StackResin& resin) {
    std::string name = resin.role;
    std::replace_if(
        name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
    return fmt::format("surfaces/{}.ply", name);
}

struct Totals {
    double distance = 0, worst = 0, modelled = 0, uncorrected = 0, outside = 0;
    bool corrected = false;
    SearchCount count;
};
Totals totals_of(const JobLayers& layers) {
    Totals totals;
    for (const ClusterLaminate& cluster : layers.clusters) {
        totals.distance += cluster.share * cluster.distance();
        totals.modelled += cluster.share * cluster.design.modelled_distance;
        if (!cluster.design.judged_distances.empty())
            totals.uncorrected += cluster.share * cluster.design.judged_distances.front();
        totals.outside += cluster.share * cluster.design.outside;
        totals.corrected = totals.corrected || !cluster.design.judged.empty();
        if (cluster.share > 0) totals.worst = std::max(totals.worst, cluster.distance());
        totals.count.visited += cluster.design.found.count.visited;
        totals.count.pruned += cluster.design.found.count.pruned;
        totals.count.judged += cluster.design.found.count.judged;
    }
    return totals;
}

/// By what light the figures were found.
const char* light_sentence(const JobLayers& layers, const Totals& totals) {
    if (totals.corrected)
        return "What they show was computed in all directions and what the layered model gets wrong corrected; figures "
               "are those of that light.";
    if (layers.measured) return "What they show is by the layered model: of measured materials nothing else is known.";
    return "What they show is by the layered model, which is rough for thin layers (--laminate-rounds 1 corrects "
           "it).";
}

const char* surface_words(const JobLayers& layers) {
    return layers.measured ? "from measured layers, with the surface that they had when they were measured,"
                           : "under a smooth surface to air";
}

std::string search_paragraph(const JobLayers& layers, const slicer::LoadedResins& resins, std::size_t clusters,
                             const Totals& totals) {
    return fmt::format(
        "The map asks for {} different profiles; for each the nearest laminate was searched and its thicknesses "
        "refined, {} and over a deep base of {}. {} Distances are weighted root mean squares of the difference in "
        "Hankel coefficients (which lie between 0 and 1): {:.4f} on average over the map, {:.4f} at most.",
        clusters, surface_words(layers), resins.entries[static_cast<std::size_t>(resins.core)].name,
        light_sentence(layers, totals), totals.distance, totals.worst);
}

std::string correction_paragraph(const Totals& totals) {
    return fmt::format(
        "Before correction the distance was {:.4f}. The layered model by itself says {:.4f} of the laminates that are "
        "printed.",
        totals.uncorrected, totals.modelled);
}

std::string gamut_paragraph(const Totals& totals) {
    return fmt::format(
        "What is wanted lies outside of the gamut of these resins, blocks and thickness: by the layered model no "
        "laminate "
        "is nearer than {:.4f}, behind the surface and on average over the map (a proven bound; the least possible of "
        "each cluster is in the table).",
        totals.outside);
}

std::string drawings_paragraph(const JobLayers& layers, std::size_t drawn_clusters) {
    std::vector<std::string> drawn;
    for (const DrawnChannel& channel : drawn_channels(layers.map.channels)) drawn.push_back(channel.name);
    return fmt::format(
        "Light that comes out per mm2 at a distance from where one unit entered, the {} most frequent clusters: dashed "
        "as wanted, full as the laminate is expected to show; {}. Both are seen through a blur of {:.2g} mm.",
        drawn_clusters, fmt::join(drawn, ", "), 1.5 * layers.grid.reach_mm() / double(layers.grid.size()));
}

std::string count_paragraph(const SearchCount& count) {
    return fmt::format(
        "The search opened {} partial laminates, put {} aside by their bounds and compared {} whole ones.",
        count.visited, count.pruned, count.judged);
}

/// The totals of all channels, or the first and the last of many.
std::string totals_text(const ChannelProfiles& of) {
    std::vector<std::string> text;
    for (const auto& channel : of) text.push_back(fmt::format("{:.3f}", channel[0]));
    return text.size() > 3 ? fmt::format("{} … {}", text.front(), text.back())
                           : fmt::format("{}", fmt::join(text, " · "));
}

io::ReportTable cluster_table(const JobLayers& layers, const slicer::LoadedResins& resins,
                              const std::vector<std::size_t>& order) {
    constexpr std::size_t most_listed = 64;
    const std::size_t listed = std::min(most_listed, order.size());
    io::ReportTable table{
        order.size() > most_listed ? fmt::format("The {} most frequent of {} clusters", most_listed, order.size())
                                   : "Clusters",
        {"cluster", "share", "distance", "least possible", "total wanted", "total reached", "layers from the top, mm"},
        {}};
    for (std::size_t i = 0; i < listed; ++i) {
        const ClusterLaminate& cluster = layers.clusters[order[i]];
        const double least = cluster.design.outside;
        table.rows.push_back({fmt::format("{}", order[i]), fmt::format("{:.1f} %", 100 * cluster.share),
                              fmt::format("{:.4f}", cluster.distance()), least > 0 ? fmt::format("{:.4f}", least) : "",
                              totals_text(cluster.target), totals_text(cluster.expected()),
                              laminate_text(cluster, resins)});
    }
    return table;
}

/// How near the laminates come to what is wanted.
io::ReportSection profiles_section(const JobLayers& layers, const slicer::LoadedResins& resins) {
    constexpr std::size_t most_drawn = 9;
    const std::vector<std::size_t> order = by_share(layers);
    const std::size_t drawn = std::min(most_drawn, order.size());
    const Totals totals = totals_of(layers);
    io::ReportSection section;
    section.title = "Scattering profiles";
    section.paragraphs.push_back(search_paragraph(layers, resins, order.size(), totals));
    if (totals.corrected) section.paragraphs.push_back(correction_paragraph(totals));
    if (totals.outside > 0) section.paragraphs.push_back(gamut_paragraph(totals));
    section.paragraphs.push_back(drawings_paragraph(layers, drawn));
    for (std::size_t i = 0; i < drawn; ++i) section.drawings.push_back(profile_drawing(layers, order[i], resins));
    section.tables.push_back(cluster_table(layers, resins, order));
    section.paragraphs.push_back(count_paragraph(totals.count));
    return section;
}

std::string sequence_paragraph(const JobLayers& layers, const slicer::LoadedResins& resins) {
    std::vector<std::string> sequence;
    for (const std::size_t material : layers.aligned.material) sequence.push_back(resins.entries[material].role);
    return fmt::format(
        "All laminates are parts of one sequence of {} layers from the top, {}; layers that a place does not have are "
        "of "
        "thickness zero there. Depths are interpolated over the map. The deepest laminate has {:.2f} mm.",
        sequence.size(), fmt::join(sequence, " "), layers.wrapped().fields().most_depth_mm());
}

std::string fit_paragraph(const LaminateFit& fit) {
    if (!(fit.thin_share > 0)) return "The body is thick enough for its laminates everywhere.";
    return fmt::format(
        "On {:.1f} % of the surface the body is too thin for its laminate, by {:.0f} % of the laminate's depth on "
        "average "
        "(behind thin walls and beside edges): layers of both sides meet there.",
        100 * fit.thin_share, 100 * fit.missing_mean);
}

io::ReportTable surfaces_table(const std::vector<SurfaceFile>& surfaces, const slicer::LoadedResins& resins) {
    io::ReportTable table{"Closed surfaces", {"file", "resin", "triangles", "volume, ml", "its voxels, ml"}, {}};
    for (const SurfaceFile& surface : surfaces)
        table.rows.push_back({surface.name, resins.entries[surface.resin].name, fmt::format("{}", surface.triangles),
                              fmt::format("{:.4f}", surface.mesh_ml), fmt::format("{:.4f}", surface.voxels_ml)});
    return table;
}

/// The laminates as they lie in the body.
io::ReportSection layers_section(const JobLayers& layers, const slicer::LoadedResins& resins,
                                 const std::optional<io::ReportPicture>& cut,
                                 const std::vector<SurfaceFile>& surfaces) {
    io::ReportSection section;
    section.title = "Layers";
    section.paragraphs = {sequence_paragraph(layers, resins), fit_paragraph(layers.fit)};
    if (cut) section.pictures.push_back(*cut);
    if (!surfaces.empty()) section.tables.push_back(surfaces_table(surfaces, resins));
    return section;
}

constexpr const char* totals_note =
    "Total reflectance of the profiles, of light that entered: as the map wants it and as the laminates are expected "
    "to "
    "show it, each place for itself. How light spreads from place to place is what the profiles below show; the "
    "appearance loop is off. `voxtone predict` on this folder shows the whole print.";

}  // namespace

std::vector<SurfaceFile> write_layer_surfaces(const std::vector<LayerSurface>& surfaces,
                                              const slicer::LoadedResins& resins, const io::StackDescription& stack,
                                              const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder / "surfaces", error);
    if (error)
        throw FileError(
            fmt::format("{}: the folder cannot be made: {}", (folder / "surfaces").string(), error.message()));
    for (const io::StackResin& resin : resins.entries) std::filesystem::remove(folder / surface_name(resin), error);
    const std::array<float, 256>& linear = io::srgb8_to_linear();
    std::vector<SurfaceFile> files;
    for (const LayerSurface& surface : surfaces) {
        const std::size_t resin = surface.material - 1u;
        const io::Rgb& code = resins.entries[resin].rgb;
        io::ColouredMesh mesh{surface.positions_mm, {}, surface.triangles};
        mesh.rgb.assign(mesh.positions_mm.size(), Eigen::Vector3f(linear[code[0]], linear[code[1]], linear[code[2]]));
        const std::string name = surface_name(resins.entries[resin]);
        io::write_whole_file(folder / name, io::ply_bytes(mesh));
        files.push_back({name, resin, surface.triangles.size(), surface.volume_mm3 * 1e-3, stack.resins[resin].ml});
    }
    return files;
}

void add_layers_report(const JobLayers& layers, const slicer::LoadedResins& resins,
                       const std::optional<io::ReportPicture>& cut, const std::vector<SurfaceFile>& surfaces,
                       io::Report& report) {
    report.sections.push_back(profiles_section(layers, resins));
    report.sections.push_back(layers_section(layers, resins, cut, surfaces));
    for (const std::string& warning : layers.warnings) report.warnings.push_back(warning);
    report.prediction_note = totals_note;
}

void draw_layers_report(const JobLayers& layers, const slicer::JobBody& body, io::Report& report,
                        const std::filesystem::path& folder, Progress& progress) {
    std::vector<Eigen::Vector3f> wanted, reached, distance;
    for (const ClusterLaminate& cluster : layers.clusters) {
        wanted.push_back(total_colour(layers.map.channels, cluster.target));
        reached.push_back(total_colour(layers.map.channels, cluster.expected()));
        distance.push_back(slicer::difference_colour(100 * cluster.distance()));
    }
    const std::array surfaces{by_cluster(layers, body, std::move(wanted)), by_cluster(layers, body, std::move(reached)),
                              by_cluster(layers, body, std::move(distance))};
    static constexpr std::array captions{
        "target: total reflectance wanted", "total reflectance of the laminates",
        "distance of the profiles: white 0, yellow 0.02, orange 0.05, red 0.1, black 0.2"};
    slicer::ReportViews views(surfaces[0], body.is_picture, 0, report, progress);
    std::array<io::Picture8, 3> drawn;
    for (std::size_t s = 0; s < surfaces.size(); ++s) drawn[s] = views.add(captions[s], surfaces[s]);
    if (!surfaces[0].triangles.empty()) {
        const std::array painted{slicer::PaintedSurface{"target", "total reflectance wanted", surfaces[0]},
                                 slicer::PaintedSurface{"print", captions[1], surfaces[1]},
                                 slicer::PaintedSurface{"distance", captions[2], surfaces[2]}};
        report.viewer.surface = slicer::viewer_painted(painted, body.grid.origin_mm, body.is_picture, false,
                                                       slicer::surface_bytes_left(report), &progress);
    }
    if (!body.is_picture) return;
    static constexpr std::array files{slicer::report_file::target_png, slicer::report_file::predicted_png,
                                      slicer::report_file::difference_png};
    for (std::size_t s = 0; s < files.size(); ++s)
        io::write_whole_file(folder / files[s], io::png_bytes(drawn[s], {views.px_per_mm(), views.px_per_mm()}));
}

io::ReportSection spread_section(const io::ProfileMap& map, const io::StackDescription& stack,
                                 const std::filesystem::path& folder, std::uint64_t seed, Progress& progress) {
    io::ReportSection section;
    section.title = "How light spreads in the print";
    // Some five seconds of a core, and the voxels are held.
    constexpr double all_paths = 3e6, most_voxels = 2e8;
    const double voxels = double(stack.size_px[0]) * stack.size_px[1] * stack.layers;
    const double places = double(map.width_px) * map.height_px * double(map.channels.size());
    if (voxels > most_voxels) {
        section.paragraphs.push_back(fmt::format(
            "Its {:.0f} million voxels were not traced here: voxtone laminate trace does that.", voxels * 1e-6));
        return section;
    }
    LaminateTraceJob job;
    job.stack = folder.string();
    job.paths = static_cast<std::uint32_t>(std::clamp(all_paths / places, 20.0, 500.0));
    job.seed = seed;
    try {
        SeenSpread seen = seen_spread(job, progress);
        section.paragraphs.push_back(
            "Every voxel was traced from each place of the map; beside what the map asks of a cluster's places stands "
            "what the print does there. voxtone laminate trace --dataset sets it beside the data, too.");
        section.paragraphs.push_back(std::move(seen.summary));
        section.tables.push_back({"Clusters", std::move(seen.header), std::move(seen.rows)});
        section.pictures.push_back({std::move(seen.caption), std::move(seen.png), seen.width_px, seen.height_px});
    } catch (const InputError& error) {
        section.paragraphs.push_back(fmt::format("It was not traced: {}.", error.what()));
    }
    return section;
}

std::string layers_summary(const JobLayers& layers) {
    const Totals totals = totals_of(layers);
    return fmt::format(
        "  {} profiles by {} layers: distance {:.4f} on average, {:.4f} at most; outside of the gamut by at least "
        "{:.4f}; {:.1f} % of the surface too thin for its laminate\n",
        by_share(layers).size(), layers.aligned.layers(), totals.distance, totals.worst, totals.outside,
        100 * layers.fit.thin_share);
}

}  // namespace voxtone::scattering

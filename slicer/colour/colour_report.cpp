// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/colour_report.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include <fmt/core.h>

#include "base/parallel.h"
#include "io/files/whole_file.h"
#include "io/models/glb_writer.h"
#include "io/pictures/picture_writer.h"
#include "io/report/report_picture.h"
#include "optics/colour/colour.h"
#include "slicer/colour/asked_alpha.h"
#include "slicer/look/prediction_files.h"
#include "slicer/look/preview.h"
#include "slicer/look/report_views.h"
#include "slicer/look/vertex_colours.h"
#include "slicer/part/report_files.h"
#include "slicer/surface/area_samples.h"
#include "slicer/surface/target_cells.h"

namespace voxtone::slicer {

namespace {

/// The visible surface with a colour that is a function of the colour that was asked for there.
template <class Map>
ColouredSurface coloured(const ColourReport& s, Map map) {
    const VisibleSurface& surface = *s.body.surface;
    ColouredSurface out;
    out.positions_mm = surface.positions_mm;
    out.triangles = surface.triangles;
    out.colour = [&surface, &requested = s.surface_colour, map](std::uint32_t t, float u, float v) {
        const auto& corner = surface.source_uv[t];
        const Eigen::Vector2f at = (1 - u - v) * corner[0] + u * corner[1] + v * corner[2];
        return Eigen::Vector3f(map(requested.at(surface.source_triangle[t], at.x(), at.y())));
    };
    return out;
}

/// Colour differences at points spread evenly over the coloured surface.
io::ReportGamut gamut_figures(const ColourReport& s) {
    constexpr std::size_t samples = 20000;
    constexpr double visible = 1.0;  // CIEDE2000; less is not called mapped
    const VisibleSurface& surface = *s.body.surface;
    io::ReportGamut gamut;
    if (surface.triangles.empty()) return gamut;
    const AreaSamples points(surface);
    const ColouredSurface target = target_surface(s);
    std::vector<double> differences(samples);
    parallel_for(0, samples, 256, [&](std::size_t i) {
        const auto [t, u, v] = points.at(1, i);
        differences[i] = s.colour.separation.gamut_distance(target.colour(t, float(u), float(v)));
    });
    const auto mapped = std::count_if(differences.begin(), differences.end(), [](double d) { return d > visible; });
    const optics::DifferenceSummary summary = optics::summarize(differences);
    gamut.mapped_share = double(mapped) / double(samples);
    gamut.mean_de2000 = summary.mean;
    gamut.p95_de2000 = summary.percentile_95;
    gamut.max_de2000 = summary.max;
    return gamut;
}

io::ReportSection mixtures_section(const ColourReport& s) {
    const Eigen::Vector3d um = s.job.printer.sliced_pitch_um();
    io::ReportSection section;
    section.title = "Mixtures";
    if (!s.job.why_these_resins.empty()) section.paragraphs.push_back(s.job.why_these_resins);
    section.paragraphs.push_back(
        s.job.options.colour.mixing == Mixing::voxels
            ? fmt::format("Colours were separated for what voxels of {:.1f} x {:.1f} x {:.1f} um look like: light that "
                          "passes between strongly coloured "
                          "ones makes a halftone brighter than an ideal mixture of the same resins.",
                          um[0], um[1], um[2])
            : std::string("Colours were separated as if resins mixed ideally (--mixing ideal); in print, voxels of "
                          "strong resins look brighter."));
    return section;
}

io::ReportPrediction predicted_figures(const JobPrediction& p) {
    static const std::vector<double> edges{0, 0.5, 1, 1.5, 2, 3, 4, 5, 7, 10, 15, 20, 30};
    io::ReportPrediction figures;
    figures.model = p.model;
    figures.cell_um = p.cell_um;
    figures.cells = p.difference.size();
    figures.seconds = p.seconds;
    figures.mean_de2000 = p.summary.mean;
    figures.median_de2000 = p.summary.median;
    figures.p95_de2000 = p.summary.percentile_95;
    figures.max_de2000 = p.summary.max;
    const std::vector<double> share = histogram_by_area(p.predicted.surface, p.difference, edges);
    for (std::size_t i = 0; i < edges.size(); ++i) figures.histogram.emplace_back(edges[i], share[i]);
    figures.note = fmt::format(
        "Predicted by the model {} from the printed voxels, in {} cells of {:.1f} x {:.1f} x {:.1f} um, relative to "
        "the same body all of white "
        "resin, in uniform white light. The target of a cell is the mean of what was asked for over it; every share is "
        "one of area.",
        p.model, p.difference.size(), p.cell_um[0], p.cell_um[1], p.cell_um[2]);
    if (const auto& errors = p.predicted.standard_error; !errors.empty())
        figures.note +=
            fmt::format(" The model's own noise, a standard error of {:.3f} on average, is part of the differences.",
                        std::accumulate(errors.begin(), errors.end(), 0.0) / double(errors.size()));
    return figures;
}

constexpr const char* difference_caption = "difference, CIEDE2000: white 0, yellow 2, orange 5, red 10, black 20";

std::vector<Eigen::Vector3f> difference_colours(const std::vector<double>& difference) {
    std::vector<Eigen::Vector3f> colours;
    for (const double d : difference) colours.push_back(difference_colour(d));
    return colours;
}

/// By how much a picture is made smaller for the page, which has room for some hundred px; the files beside it have
/// every cell.
std::uint32_t page_step(const io::LinearPicture& picture) {
    constexpr std::uint32_t most_px = 640;
    return (std::max(picture.width_px, picture.height_px) + most_px - 1) / most_px;
}

/// The mean of what is covered of `step` x `step` pixels.
io::LinearPicture smaller_picture(const io::LinearPicture& large, std::uint32_t step) {
    io::LinearPicture small{(large.width_px + step - 1) / step, (large.height_px + step - 1) / step, {}};
    small.pixels.assign(std::size_t{small.width_px} * small.height_px, Eigen::Vector4f::Zero());
    for (std::uint32_t y = 0; y < large.height_px; ++y)
        for (std::uint32_t x = 0; x < large.width_px; ++x) {
            const Eigen::Vector4f& from = large.pixels[std::size_t{y} * large.width_px + x];
            small.pixels[std::size_t{y / step} * small.width_px + x / step] +=
                Eigen::Vector4f(from[3] * from[0], from[3] * from[1], from[3] * from[2], from[3]);
        }
    for (Eigen::Vector4f& pixel : small.pixels) {
        if (pixel[3] > 0) pixel.head<3>() /= pixel[3];
        pixel[3] /= float(step * step);
    }
    return small;
}

/// Pictures of a slab from above, one pixel per cell.
void draw_predicted_picture(const ColourReport& s, const JobPrediction& p, io::Report& report,
                            const std::filesystem::path& folder) {
    const auto px_per_mm = picture_px_per_mm(p.volume, p.predicted.surface.cell_voxels);
    struct Drawn {
        const char* caption;
        std::string_view file;  ///< empty: for the page alone
        std::vector<Eigen::Vector3f> rgb;
    };
    std::vector<Drawn> drawn{{"target", report_file::target_png, p.target},
                             {"predicted", report_file::predicted_png, p.predicted.rgb},
                             {difference_caption, report_file::difference_png, difference_colours(p.difference)}};
    if (!p.open_loop.empty()) {
        drawn.push_back({"open loop: without the appearance loop", report_file::open_loop_png, p.open_loop});
        drawn.push_back(
            {"difference of the open loop", "", difference_colours(colour_differences(p.target, p.open_loop))});
    }
    if (s.translucency) {
        auto maps = alpha_of_cells(p.predicted.surface, p.volume.pitch_mm(), s.body, *s.translucency);
        for (std::size_t map = 0; map < maps.size(); ++map)
            drawn.push_back({alpha_maps()[map].caption, "", std::move(maps[map])});
    }
    std::vector<io::ReportPicture> pictures(drawn.size());
    parallel_for(0, drawn.size(), 1, [&](std::size_t i) {
        const io::LinearPicture whole = top_picture(p.volume, cells_in_colours(p.predicted, drawn[i].rgb));
        if (!drawn[i].file.empty())
            io::write_whole_file(folder / drawn[i].file, io::png_bytes(io::encode_transparent(whole), px_per_mm));
        const std::uint32_t step = page_step(whole);
        const io::Picture8 codes = io::encode_transparent(smaller_picture(whole, step));
        pictures[i] = io::report_picture(drawn[i].caption, codes, px_per_mm[0] / step);
    });
    report.views.push_back({"top", std::move(pictures)});
    io::write_whole_file(folder / report_file::predicted_exr,
                         io::exr_bytes(top_numbers(p.volume, p.channels, p.predicted), px_per_mm));
    io::write_whole_file(folder / report_file::target_exr,
                         io::exr_bytes(top_picture(p.volume, cells_in_colours(p.predicted, p.target)), px_per_mm));
}

/// As fine as the prediction that is looked at beside it, as far as a picture of the whole shows that.
double looked_at_edge_mm(const JobBody& body) {
    constexpr double of_all = 1.0 / 300;
    // Halved until none is longer, edges are as long as a cell of two by two voxels, most of them.
    const double longest_mm = 4 * std::min(body.grid.pitch_mm.x(), body.grid.pitch_mm.y());
    return std::max(longest_mm, of_all * body.placement.extent_mm.maxCoeff());
}

void write_body_colours(const ColouredSurface& surface, double edge_mm, const std::filesystem::path& file,
                        const char* name, const Progress& progress) {
    const VertexColourOptions options{.edge_mm = edge_mm};
    io::write_whole_file(file, io::glb_bytes(vertex_colours(surface, options, &progress).mesh, name));
}

ReportViews views_of(const ColouredSurface& target, const ColourReport& s, io::Report& report,
                     const Progress& progress) {
    // Colours are filtered to the printer's resolution.
    return {target, s.body.is_picture, s.body.grid.pitch_mm.y(), report, progress};
}

void add_alpha_maps(const ColourReport& s, ReportViews& views) {
    if (!s.translucency) return;
    std::vector<std::string> captions;
    for (const AlphaMap& map : alpha_maps()) captions.emplace_back(map.caption);
    views.add(captions, PrintedAlpha(*s.body.surface, s.surface_colour, *s.translucency).maps());
}

io::ReportSection translucency_section(const io::ReportTranslucency& alpha) {
    io::ReportSection section;
    section.title = "Translucency";
    section.paragraphs.push_back(fmt::format(
        "Alpha {:.2f} is asked for on average over the coloured surface, of which the resins show {:.2f} in a wide "
        "slab. {:.0f} % of the surface gives up more than 0.05, at the most {:.2f}; the maps of alpha say where.",
        alpha.asked_mean, alpha.shown_mean, 100 * alpha.given_up_share, alpha.given_up_max));
    return section;
}

/// Without a prediction: what the separation says.
void draw_separated(const ColourReport& s, io::Report& report, const std::filesystem::path& folder,
                    const Progress& progress) {
    const ColouredSurface target = target_surface(s), predicted = separated_surface(s);
    ReportViews views = views_of(target, s, report, progress);
    const io::Picture8 requested = views.add("target", target), shown = views.add("predicted", predicted);
    add_alpha_maps(s, views);
    if (s.body.is_picture) {
        const std::array<double, 2> px_per_mm{views.px_per_mm(), views.px_per_mm()};
        io::write_whole_file(folder / report_file::target_png, io::png_bytes(requested, px_per_mm));
        io::write_whole_file(folder / report_file::predicted_png, io::png_bytes(shown, px_per_mm));
    } else {
        const double edge_mm = looked_at_edge_mm(s.body);
        write_body_colours(target, edge_mm, folder / report_file::target_glb, "target", progress);
        write_body_colours(predicted, edge_mm, folder / report_file::predicted_glb, "predicted", progress);
    }
}

/// The prediction is a mesh of its own, one vertex per cell; the map of differences too. A body of a few voxels has too
/// few cells for one.
void draw_predicted_body(const ColourReport& s, const JobPrediction& p, io::Report& report,
                         const std::filesystem::path& folder, const Progress& progress) {
    if (s.cell_triangles.empty()) return draw_separated(s, report, folder, progress);
    const Eigen::Vector3d& origin = s.body.grid.origin_mm;
    const io::ColouredMesh cells = body_mesh(s.cell_triangles, {origin.x(), origin.y(), origin.z()}, p.predicted);
    const std::vector<Eigen::Vector3f> differences = difference_colours(p.difference);
    const ColouredSurface target = target_surface(s);
    const auto draw_views = [&] {
        std::vector<Eigen::Vector3d> positions;
        std::vector<std::string> captions{"predicted", difference_caption};
        std::vector<ColouredSurface> surfaces{mesh_surface(cells, positions)};
        surfaces.push_back(recoloured(surfaces[0], differences));
        if (!p.open_loop.empty()) {
            captions.emplace_back("open loop: without the appearance loop");
            surfaces.push_back(recoloured(surfaces[0], p.open_loop));
        }
        ReportViews views = views_of(target, s, report, progress);
        views.add("target", target);
        views.add(captions, surfaces);
        add_alpha_maps(s, views);
    };
    // Meshes are written by one thread each.
    parallel_for(0, 3, 1, [&](std::size_t task) {
        if (task == 0) draw_views();
        if (task == 1) io::write_whole_file(folder / report_file::predicted_glb, io::glb_bytes(cells, "predicted"));
        if (task == 2)
            write_body_colours(target, looked_at_edge_mm(s.body), folder / report_file::target_glb, "target", progress);
    });
}

constexpr const char* separation_note =
    "Predicted with the separation's own model: every point as on a wide flat shell of its colour over deep core, "
    "relative to the core resin's white. It shows what the resins can reach. It leaves out how light spreads between "
    "neighbouring colours, at edges and in thin parts.";

}  // namespace

SurfacePrediction cells_in_colours(const SurfacePrediction& cells, const std::vector<Eigen::Vector3f>& rgb) {
    SurfacePrediction out;
    out.surface.cell_voxels = cells.surface.cell_voxels;
    out.surface.cells = cells.surface.cells;
    out.channels = 3;
    out.rgb = rgb;
    return out;
}

ColouredSurface target_surface(const ColourReport& s) {
    return coloured(s, [](const Eigen::Vector3f& rgb) { return rgb; });
}

ColouredSurface separated_surface(const ColourReport& s) {
    const halftone::Separation& separation = s.colour.separation;
    return coloured(s, [&separation](const Eigen::Vector3f& rgb) {
        return Eigen::Vector3f(separation.predicted(rgb).cast<float>().cwiseMax(0.0f).cwiseMin(1.0f));
    });
}

void add_colour_report(const ColourReport& s, const std::string& why_not_predicted, io::Report& report) {
    report.gamut = gamut_figures(s);
    if (s.prediction) {
        report.prediction = predicted_figures(*s.prediction);
    } else {
        report.prediction_note = separation_note;
        if (!why_not_predicted.empty()) report.prediction_note += " " + why_not_predicted;
    }
    report.sections.push_back(mixtures_section(s));
    if (!s.translucency) return;
    report.translucency = PrintedAlpha(*s.body.surface, s.surface_colour, *s.translucency).figures();
    report.sections.push_back(translucency_section(*report.translucency));
}

void add_remarks(const std::optional<JobLoop>& loop, const std::optional<JobPrediction>& prediction,
                 io::Report& report) {
    const auto add = [&report](const std::vector<std::string>& remarks) {
        report.warnings.insert(report.warnings.end(), remarks.begin(), remarks.end());
    };
    if (loop) add(loop->result.remarks);
    if (prediction) add(prediction->predicted.remarks);
}

void draw_colour_report(const ColourReport& s, io::Report& report, const std::filesystem::path& folder,
                        Progress& progress) {
    if (!s.prediction)
        draw_separated(s, report, folder, progress);
    else if (s.body.is_picture)
        draw_predicted_picture(s, *s.prediction, report, folder);
    else
        draw_predicted_body(s, *s.prediction, report, folder, progress);
}

std::string colour_summary(const io::Report& report) {
    std::string text;
    if (report.verdict) text += fmt::format("  {}\n", report.verdict->sentence);
    if (report.prediction)
        text += fmt::format(
            "  cell by cell, before the eye blurs them: CIEDE2000 mean {:.2f}, median {:.2f}, 95 % {:.2f}, max {:.2f} "
            "(cells of {:.0f} um)\n",
            report.prediction->mean_de2000, report.prediction->median_de2000, report.prediction->p95_de2000,
            report.prediction->max_de2000, report.prediction->cell_um[0]);
    if (report.gamut)
        text += fmt::format(
            "  out of the resins' reach, on a thick body: {:.1f} % of the surface; moved by CIEDE2000 mean {:.2f}, 95 "
            "% "
            "{:.2f}, max {:.2f}\n",
            100 * report.gamut->mapped_share, report.gamut->mean_de2000, report.gamut->p95_de2000,
            report.gamut->max_de2000);
    return text;
}

}  // namespace voxtone::slicer

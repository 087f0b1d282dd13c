// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/job/slice_report.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/core.h>
#include <Eigen/Geometry>

#include "voxtone/base/parallel.h"
#include "voxtone/base/peak_memory.h"
#include "voxtone/io/files/whole_file.h"
#include "voxtone/io/models/glb_writer.h"
#include "voxtone/io/pictures/picture_writer.h"
#include "voxtone/optics/colour/colour.h"
#include "voxtone/slicer/job/layers_report.h"
#include "voxtone/slicer/job/loop_report.h"
#include "voxtone/slicer/look/prediction_files.h"
#include "voxtone/slicer/look/preview.h"
#include "voxtone/slicer/look/vertex_colours.h"
#include "voxtone/slicer/surface/area_samples.h"
#include "voxtone/slicer/surface/target_cells.h"

#ifndef VOXTONE_VERSION
#error "the build defines the program's version"
#endif

namespace voxtone::slicer {

namespace {

/// The visible surface with a colour that is a function of the colour that was asked for there.
template <class Map>
ColouredSurface coloured(const ReportSources& s, Map map) {
    const VisibleSurface& surface = *s.body.surface;
    ColouredSurface out;
    out.positions_mm = surface.positions_mm;
    out.triangles = surface.triangles;
    out.colour = [&surface, &s, map](std::uint32_t t, float u, float v) {
        const auto& corner = surface.source_uv[t];
        const Eigen::Vector2f at = (1 - u - v) * corner[0] + u * corner[1] + v * corner[2];
        return Eigen::Vector3f(map(s.surface_colour.at(surface.source_triangle[t], at.x(), at.y())));
    };
    return out;
}

ColouredSurface target_surface(const ReportSources& s) {
    return coloured(s, [](const Eigen::Vector3f& rgb) { return rgb; });
}
ColouredSurface predicted_surface(const ReportSources& s) {
    const halftone::Separation& separation = s.colour->separation;
    return coloured(s, [&separation](const Eigen::Vector3f& rgb) {
        return Eigen::Vector3f(separation.predicted(rgb).cast<float>().cwiseMax(0.0f).cwiseMin(1.0f));
    });
}

/// Colour differences at points spread evenly over the coloured surface.
io::ReportGamut gamut_figures(const ReportSources& s) {
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
        differences[i] = s.colour->separation.mapping_distance(target.colour(t, float(u), float(v)));
    });
    const auto mapped = std::count_if(differences.begin(), differences.end(), [](double d) { return d > visible; });
    const optics::DifferenceSummary summary = optics::summarize(differences);
    gamut.mapped_share = double(mapped) / double(samples);
    gamut.mean_de2000 = summary.mean;
    gamut.p95_de2000 = summary.percentile_95;
    gamut.max_de2000 = summary.max;
    return gamut;
}

io::ReportSection throughput(const ReportSources& s, const JobFigures& f) {
    const double voxels = double(s.body.grid.size[0]) * s.body.grid.size[1] * s.stack.layers;
    const double cpu_s =
        f.counts.solid_s + f.counts.shell_s + f.counts.colour_s + f.counts.screen_s + f.counts.runs_s + f.encode_s;
    const auto row = [&](const char* what, double seconds) {
        return std::vector<std::string>{
            what, fmt::format("{:.2f}", seconds), fmt::format("{:.0f} %", cpu_s > 0 ? 100 * seconds / cpu_s : 0),
            fmt::format("{:.1f}", f.counts.shell_voxels ? seconds / double(f.counts.shell_voxels) * 1e9 : 0)};
    };
    io::ReportSection section;
    section.title = "Speed of the layers";
    section.paragraphs.push_back(fmt::format(
        "{:.3g} voxels in {:.2f} s of layers: {:.0f} million voxels/s; {:.3g} of them in the coloured shell; "
        "{:.1f} MB of layers written, {:.1f} MB/s.",
        voxels, f.layers_s, voxels / f.layers_s * 1e-6, double(f.counts.shell_voxels), double(f.layer_bytes) * 1e-6,
        double(f.layer_bytes) * 1e-6 / f.layers_s));
    section.tables.push_back({"Layers, summed over threads",
                              {"work", "seconds", "share", "ns per shell voxel"},
                              {row("solid", f.counts.solid_s), row("nearest surface", f.counts.shell_s),
                               row("target colour", f.counts.colour_s), row("separation and screen", f.counts.screen_s),
                               row("runs", f.counts.runs_s), row("encode and write", f.encode_s)}});
    return section;
}

io::ReportSection colour_section(const ReportSources& s) {
    const std::array<double, 3>& um = s.stack.pitch_um;
    io::ReportSection section;
    section.title = "Mixtures";
    section.paragraphs.push_back(
        s.options.mixing == "voxels"
            ? fmt::format("Colours were separated for what voxels of {:.1f} x {:.1f} x {:.1f} um look like: light that "
                          "passes between strongly coloured "
                          "ones makes a halftone brighter than an ideal mixture of the same resins.",
                          um[0], um[1], um[2])
            : std::string("Colours were separated as if resins mixed ideally (--mixing ideal); in print, voxels of "
                          "strong resins look brighter."));
    return section;
}

io::ReportSection mesh_section(const RepairReport& r) {
    io::ReportSection section;
    section.title = "The mesh";
    for (const std::string& message : r.messages) section.paragraphs.push_back(message);
    if (r.messages.empty()) section.paragraphs.push_back("The mesh encloses a body as it is; nothing was repaired.");
    const auto row = [](const char* what, std::size_t before, std::size_t after) {
        return std::vector<std::string>{what, fmt::format("{}", before), fmt::format("{}", after)};
    };
    section.tables.push_back(
        {"Diagnosis",
         {"", "as read", "as printed"},
         {row("triangles", r.before.triangles, r.after.triangles), row("shells", r.before.shells, r.after.shells),
          row("boundary edges", r.before.boundary_edges, r.after.boundary_edges),
          row("non-manifold edges", r.before.nonmanifold_edges, r.after.nonmanifold_edges),
          row("inconsistent edges", r.before.inconsistent_edges, r.after.inconsistent_edges),
          row("edges that do not close", r.before.open_edges, r.after.open_edges),
          row("faces without area", r.before.degenerate_faces, r.after.degenerate_faces),
          row("doubled faces", r.before.duplicate_faces, r.after.duplicate_faces)}});
    return section;
}

io::ReportPicture report_picture(const char* caption, const Preview& preview) {
    const io::Picture8 codes = io::encode_transparent(preview.picture);
    return {caption, io::png_bytes(codes, {preview.px_per_mm, preview.px_per_mm}), codes.width_px, codes.height_px,
            preview.px_per_mm};
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

/// The same cells with other colours; numbers are the colours.
SurfacePrediction recoloured(const SurfacePrediction& cells, const std::vector<Eigen::Vector3f>& rgb) {
    SurfacePrediction out;
    out.surface.cell_voxels = cells.surface.cell_voxels;
    out.surface.cells = cells.surface.cells;
    out.channels = 3;
    out.rgb = rgb;
    return out;
}

/// Pictures of a slab from above, one pixel per cell.
void draw_picture_prediction(const ReportSources& s, io::Report& report, const std::filesystem::path& folder) {
    const JobPrediction& p = *s.prediction;
    const auto px_per_mm = picture_px_per_mm(p.volume, p.predicted.surface.cell_voxels);
    const auto draw = [&](const char* caption, const std::vector<Eigen::Vector3f>& rgb) {
        const io::Picture8 codes = io::encode_transparent(top_picture(p.volume, recoloured(p.predicted, rgb)));
        return io::ReportPicture{caption, io::png_bytes(codes, px_per_mm), codes.width_px, codes.height_px,
                                 px_per_mm[0]};
    };
    report.views.push_back({"top",
                            {draw("target", p.target), draw("predicted", p.predicted.rgb),
                             draw(difference_caption, difference_colours(p.difference))}});
    if (!p.open_loop.empty()) {
        auto& with_open = report.views[0].pictures;
        with_open.push_back(draw("open loop: without the appearance loop", p.open_loop));
        with_open.push_back(
            draw("difference of the open loop", difference_colours(colour_differences(p.target, p.open_loop))));
        io::write_whole_file(folder / "open-loop.png", with_open[3].png);
    }
    const auto& pictures = report.views[0].pictures;
    io::write_whole_file(folder / "target.png", pictures[0].png);
    io::write_whole_file(folder / "predicted.png", pictures[1].png);
    io::write_whole_file(folder / "difference.png", pictures[2].png);
    const auto& channels = s.resins.set.channels;
    io::write_whole_file(folder / "predicted.exr",
                         io::exr_bytes(top_numbers(p.volume, channels, p.predicted), px_per_mm));
    io::write_whole_file(folder / "target.exr",
                         io::exr_bytes(top_picture(p.volume, recoloured(p.predicted, p.target)), px_per_mm));
}

void write_body_colours(const ColouredSurface& surface, const std::filesystem::path& file, const char* name,
                        const Progress& progress) {
    io::write_whole_file(file, io::glb_bytes(vertex_colours(surface, {}, &progress).mesh, name));
}

}  // namespace

io::Report make_report(const ReportSources& s, const JobFigures& f) {
    io::Report report;
    report.title = std::filesystem::path(s.options.model).filename().string();
    report.program_version = VOXTONE_VERSION;
    report.printer_id = s.printer.id;
    report.printer_name = s.printer.name;
    report.pitch_um = s.stack.pitch_um;
    report.size_mm = {s.body.placement.extent_mm.x(), s.body.placement.extent_mm.y(), s.body.placement.extent_mm.z()};
    report.size_px = {s.stack.size_px[0], s.stack.size_px[1], s.stack.layers};
    report.body_voxels = f.counts.body_voxels;
    for (std::size_t r = 0; r < s.stack.resins.size(); ++r) {
        const io::StackResin& resin = s.stack.resins[r];
        report.resins.push_back(
            {s.resins.set.resins[r].name, resin.role, resin.name, resin.rgb, resin.voxels, resin.ml});
    }
    report.warnings = s.printer.warnings();
    report.warnings.insert(report.warnings.end(), s.body.warnings.begin(), s.body.warnings.end());
    if (f.counts.thin_voxels > 0)
        report.warnings.push_back(
            fmt::format("{} voxels were added where the body is thinner than a voxel, so that nothing vanishes",
                        f.counts.thin_voxels));
    report.stages = {{"read model", f.read_s}, {"repair and visible surface", f.repair_s}};
    if (s.colour)
        report.stages.insert(report.stages.end(),
                             {{"separate colours", f.separation_s}, {"appearance loop", f.loop_s}});
    if (s.layers)
        report.stages.insert(report.stages.end(), {{"profiles of the resins", s.layers->materials_s},
                                                   {"search stacks", s.layers->search_s}});
    report.stages.insert(report.stages.end(), {{"layers", f.layers_s}, {"finish", f.finish_s}});
    report.total_seconds = f.total_s + (s.prediction ? s.prediction->seconds : 0);
    report.peak_memory_bytes = peak_memory_bytes();
    report.output_bytes = f.layer_bytes;
    if (s.colour) report.gamut = gamut_figures(s);
    if (s.prediction) {
        report.prediction = predicted_figures(*s.prediction);
        report.stages.push_back({"predict", s.prediction->seconds});
    } else if (s.colour) {
        report.prediction_note =
            "Predicted with the separation's own model: every point as on a wide flat shell of its colour over deep "
            "core, relative to the core "
            "resin's white. It shows what the resins can reach. It leaves out how light spreads between neighbouring "
            "colours, at edges and in "
            "thin parts.";
        if (!s.why_not.empty()) report.prediction_note += " " + s.why_not;
    }
    if (s.loop) report.loop = loop_report(*s.loop, s.body, s.prediction ? &s.prediction->volume : nullptr, s.palette);
    if (!s.why_no_loop.empty()) report.warnings.push_back(s.why_no_loop);
    if (s.colour) report.sections.push_back(colour_section(s));
    if (s.layers) add_layers_report(*s.layers, s.resins, f.cut, s.surfaces, report);
    report.sections.push_back(mesh_section(s.body.repair));
    report.sections.push_back(throughput(s, f));
    report.layers = f.layers;
    for (const OptionSpec& spec : slice_option_table()) report.job.emplace_back(spec.key, spec.get(s.options));
    return report;
}

void draw_report(const ReportSources& s, io::Report& report, const std::filesystem::path& folder, Progress& progress) {
    if (s.layers) return draw_layers_report(*s.layers, s.body, report, folder, progress);
    if (s.prediction && s.body.is_picture) return draw_picture_prediction(s, report, folder);
    const ColouredSurface target = target_surface(s);
    // The prediction is a mesh of its own, one vertex per cell; the map of differences too.
    io::ColouredMesh cells, differences;
    std::vector<Eigen::Vector3d> positions;
    ColouredSurface predicted, difference;
    if (s.prediction) {
        const Eigen::Vector3d& origin = s.body.grid.origin_mm;
        cells = body_mesh(s.prediction->volume, {origin.x(), origin.y(), origin.z()}, s.prediction->predicted);
        predicted = mesh_surface(cells, positions);
        differences.triangles = cells.triangles;
        differences.rgb = difference_colours(s.prediction->difference);
        differences.positions_mm = cells.positions_mm;
        difference = mesh_surface(differences, positions);
    } else {
        predicted = predicted_surface(s);
    }
    static constexpr View top_only[] = {View::top};
    const std::span<const View> views = s.body.is_picture ? std::span<const View>(top_only) : all_views();
    PreviewOptions options;
    options.samples = 3;
    if (s.body.is_picture) options.margin_px = 0;
    options.px_per_mm = std::min(fitting_scale(target, views, s.body.is_picture ? 1000 : 640, options), 1 / 0.085);
    // The colours are filtered to the printer's resolution, which a small picture of a large body undersamples.
    options.colour_per_sample = 1 / options.px_per_mm > 1.5 * s.stack.pitch_um[1] * 1e-3;
    const std::vector<Preview> asked = render_views(target, views, options, &progress),
                               shown = render_views(predicted, views, options, &progress);
    for (std::size_t v = 0; v < views.size(); ++v)
        report.views.push_back(
            {view_name(views[v]), {report_picture("target", asked[v]), report_picture("predicted", shown[v])}});
    if (s.prediction) {
        const std::vector<Preview> maps = render_views(difference, views, options, &progress);
        for (std::size_t v = 0; v < views.size(); ++v)
            report.views[v].pictures.push_back(report_picture(difference_caption, maps[v]));
        if (!s.prediction->open_loop.empty()) {
            cells.rgb = s.prediction->open_loop;
            const std::vector<Preview> open = render_views(mesh_surface(cells, positions), views, options, &progress);
            for (std::size_t v = 0; v < views.size(); ++v)
                report.views[v].pictures.push_back(report_picture("open loop: without the appearance loop", open[v]));
            cells.rgb = s.prediction->predicted.rgb;
        }
    }
    if (s.body.is_picture) {
        io::write_whole_file(folder / "target.png", report.views[0].pictures[0].png);
        io::write_whole_file(folder / "predicted.png", report.views[0].pictures[1].png);
    } else {
        write_body_colours(target, folder / "target.glb", "target", progress);
        if (s.prediction)
            io::write_whole_file(folder / "predicted.glb", io::glb_bytes(cells, "predicted"));
        else
            write_body_colours(predicted, folder / "predicted.glb", "predicted", progress);
    }
}

std::string summary_text(const ReportSources& s, const io::Report& report, const JobFigures& f,
                         const std::filesystem::path& folder) {
    std::string text = fmt::format("{}: {:.2f} x {:.2f} x {:.2f} mm, {} x {} px, {} layers of {:g} um\n",
                                   folder.string(), report.size_mm[0], report.size_mm[1], report.size_mm[2],
                                   report.size_px[0], report.size_px[1], report.size_px[2], report.pitch_um[2]);
    for (const io::ReportResin& resin : report.resins)
        text += fmt::format("  {:<3} {:<16} {:9.3f} ml\n", resin.role, resin.name, resin.ml);
    if (report.gamut)
        text += fmt::format(
            "  colours moved into the gamut: {:.1f} % of the surface; CIEDE2000 mean {:.2f}, 95 % {:.2f}, max {:.2f}\n",
            100 * report.gamut->mapped_share, report.gamut->mean_de2000, report.gamut->p95_de2000,
            report.gamut->max_de2000);
    if (s.layers) text += layers_summary(*s.layers);
    if (report.prediction)
        text += fmt::format(
            "  predicted against asked for: CIEDE2000 mean {:.2f}, median {:.2f}, 95 % {:.2f}, max {:.2f} (cells of "
            "{:.0f} um, {:.2f} s)\n",
            report.prediction->mean_de2000, report.prediction->median_de2000, report.prediction->p95_de2000,
            report.prediction->max_de2000, report.prediction->cell_um[0], report.prediction->seconds);
    const double voxels = double(report.size_px[0]) * report.size_px[1] * report.size_px[2];
    text += fmt::format("  {:.3g} voxels in {:.2f} s ({:.0f} million/s), peak memory {:.0f} MB\n", voxels, f.total_s,
                        voxels / f.total_s * 1e-6, double(report.peak_memory_bytes) * 1e-6);
    for (const SurfaceFile& surface : s.surfaces)
        text += fmt::format("  {}: {} triangles, {:.4f} ml\n", (folder / surface.name).string(), surface.triangles,
                            surface.mesh_ml);
    return text;
}

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/slice_report.h"

#include <fmt/core.h>

#include "base/machine_memory.h"
#include "base/process_usage.h"
#include "base/progress_bar.h"
#include "base/warning.h"
#include "io/files/whole_file.h"
#include "io/profiles/lamp_file.h"
#include "io/programs/build_identity.h"
#include "io/report/report_html.h"
#include "io/report/report_picture.h"
#include "slicer/look/air_under.h"
#include "slicer/options/job_file.h"
#include "slicer/options/option_table.h"
#include "slicer/part/phase.h"
#include "slicer/part/report_files.h"

namespace voxtone::slicer {

namespace {

io::ReportSection throughput(const io::StackDescription& stack, const JobMeasurements& f) {
    const double voxels = double(stack.size_px[0]) * stack.size_px[1] * stack.layers;
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

io::ReportSection cavity_section(const std::vector<Cavity>& voids) {
    io::ReportSection section;
    section.title = "Voids";
    section.paragraphs.push_back(
        "Space within the body that cannot be reached from outside but through openings narrower than a quarter of a "
        "millimetre. What is kept is filled with support material.");
    io::ReportTable table{"By size", {"volume, mm^3", "centre from the model's corner, mm", "wall, mm", ""}, {}};
    for (const Cavity& v : voids)
        table.rows.push_back(
            {v.volume_mm3 < 100 ? fmt::format("{:.3g}", v.volume_mm3) : fmt::format("{:.0f}", v.volume_mm3),
             fmt::format("{:.1f}, {:.1f}, {:.1f}", v.centre_mm[0], v.centre_mm[1], v.centre_mm[2]),
             fmt::format("{:.2g}", v.wall_mm), v.filled ? "filled with resin" : "kept"});
    section.tables.push_back(std::move(table));
    return section;
}

void append_stages(std::vector<io::ReportStage>& to, const std::vector<io::ReportStage>& from) {
    to.insert(to.end(), from.begin(), from.end());
}

/// What was printed, on what, of which resins.
void add_print(const OpenedJob& job, const JobBody& body, const io::StackDescription& stack, io::Report& report) {
    report.title = body.name.empty() ? std::filesystem::path(job.options.model).filename().string() : body.name;
    report.program_version = io::program_version();
    report.printer_id = job.printer.id;
    report.printer_name = job.printer.name;
    report.pitch_um = stack.pitch_um;
    report.size_mm = {body.placement.extent_mm.x(), body.placement.extent_mm.y(), body.placement.extent_mm.z()};
    report.size_px = {stack.size_px[0], stack.size_px[1], stack.layers};
    report.printing = printing_of(job.printer, body.placement.extent_mm, stack.layers);
    if (int(stack.layers) == body.grid.size[2]) report.printing.support_ml = look_under(*body.solid).ml;
    for (std::size_t r = 0; r < stack.resins.size(); ++r) {
        const io::StackResin& resin = stack.resins[r];
        report.resins.push_back(
            {job.resins.set.resins[r].name, resin.role, resin.name, resin.rgb, resin.voxels, resin.ml});
    }
    for (const OptionSpec& spec : slice_option_table())
        if (!spec.is_preset() && !spec.is_of_another(job.options.raw))
            report.job.emplace_back(spec.key, option_value(spec, job.options.raw));
}

std::vector<std::string> warnings_of(const OpenedJob& job, const JobBody& body, const JobMeasurements& f) {
    std::vector<std::string> warnings = job.printer.warnings();
    if (const auto doubt = io::lamp_doubt(job.options.resins, job.options.illuminant)) warnings.push_back(*doubt);
    warnings.insert(warnings.end(), body.warnings.begin(), body.warnings.end());
    if (f.counts.thin_voxels > 0)
        warnings.push_back(named_warning(
            "thin-walls",
            fmt::format("{} voxels were added where the body is thinner than a voxel, so that nothing vanishes",
                        f.counts.thin_voxels)));
    return warnings;
}

/// Where most of the time went: " (appearance loop 43 s, predict 27 s)".
std::string longest_stages(const std::vector<io::ReportStage>& stages, double total_s) {
    constexpr double worth_telling = 0.15;  // of the total
    std::string text;
    for (const io::ReportStage& stage : stages)
        if (stage.seconds > worth_telling * total_s)
            text += fmt::format("{}{} {}", text.empty() ? "" : ", ", stage.name, duration_text(stage.seconds));
    return text.empty() ? text : " (" + text + ")";
}

}  // namespace

io::ReportPrinting printing_of(const PrinterProfile& printer, const Eigen::Vector3d& extent_mm, std::uint64_t layers) {
    PrintingTime time;
    time.add(printer.sliced_passes(), extent_mm, layers);
    return {time.passes_of_layer, time.passes, time.seconds, time.source, {}};
}

io::Report make_report(const OpenedJob& job, const JobBody& body, const io::StackDescription& stack, const Print& print,
                       const JobMeasurements& f) {
    io::Report report;
    add_print(job, body, stack, report);
    report.body_voxels = f.counts.body_voxels;
    report.warnings = warnings_of(job, body, f);
    report.stages = {{"read model", f.read_s}, {"repair and visible surface", f.repair_s}};
    append_stages(report.stages, print.stages_before_layers());
    append_stages(report.stages, {{std::string(name_of(Phase::layers)), f.layers_s},
                                  {std::string(name_of(Phase::finish)), f.finish_s}});
    append_stages(report.stages, print.stages_after_layers());
    report.peak_memory_bytes = peak_memory_bytes();
    report.output_bytes = f.layer_bytes;
    print.add_to(report);
    report.sections.push_back(mesh_section(body.repair));
    if (!body.repair.voids.empty()) report.sections.push_back(cavity_section(body.repair.voids));
    report.sections.push_back(throughput(stack, f));
    return report;
}

void write_page(const std::filesystem::path& folder, const io::Report& report) {
    io::write_whole_file(folder / report_file::page, io::report_html(report));
    const io::ReportPicture* const shown = io::shown_picture(report);
    if (!shown) return;
    io::write_whole_file(folder / report_file::preview, shown->file);
    const io::ReportPicture& target = report.views[0].pictures[0];
    if (&target != shown) io::write_whole_file(folder / report_file::target_preview, target.file);
}

std::string summary_text(const Print& print, const io::Report& report, double total_s, bool has_report,
                         const std::filesystem::path& folder) {
    std::string text = fmt::format("{}: {:.2f} x {:.2f} x {:.2f} mm, {} x {} px, {} layers of {:g} um\n",
                                   folder.string(), report.size_mm[0], report.size_mm[1], report.size_mm[2],
                                   report.size_px[0], report.size_px[1], report.size_px[2], report.pitch_um[2]);
    for (const io::ReportResin& resin : report.resins)
        text += fmt::format("  {:<3} {:<16} {:9.3f} ml\n", resin.role, resin.shown_name(), resin.ml);
    text += print.summary(report);
    text += fmt::format("  done in {}{}; peak memory {}\n", duration_text(total_s),
                        longest_stages(report.stages, total_s), memory_text(report.peak_memory_bytes));
    text += print.written_text();
    if (has_report) text += fmt::format("  report: {}\n", (folder / report_file::page).string());
    return text;
}

}  // namespace voxtone::slicer

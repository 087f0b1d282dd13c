// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/tray_report.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/process_usage.h"
#include "base/progress_bar.h"
#include "base/warning.h"
#include "io/files/whole_file.h"
#include "io/layers/stack_folder.h"
#include "io/programs/build_identity.h"
#include "io/report/report_json.h"
#include "io/report/report_picture.h"
#include "slicer/look/composed_surface.h"
#include "slicer/look/report_views.h"
#include "slicer/look/viewer_surface.h"
#include "slicer/part/report_files.h"
#include "slicer/plans/part_about.h"
#include "slicer/plate/component_surface.h"
#include "slicer/plate/opened_tray.h"
#include "slicer/plate/slice_report.h"
#include "slicer/plate/tray_verdict.h"

namespace voxtone::slicer {

namespace {

/// Of the page, for the surfaces of all copies; the rest is for pictures and voxels.
constexpr std::size_t surface_bytes = 3'600'000;

io::ReportPart row_of(const ReadyPart& part, const io::Report& own) {
    constexpr std::uint32_t most_px = 112;  // shown half as large
    io::ReportPart row;
    row.name = part.ready->body.name.empty() ? part.part.name : part.ready->body.name;
    row.page = fmt::format("{}/{}/{}", io::parts_name, part.part.name, report_file::page);
    if (const io::ReportPicture* const shown = io::shown_picture(own))
        row.picture = io::small_report_picture(*shown, most_px);
    for (const io::ReportResin& resin : own.resins) row.ml += resin.ml;
    if (own.verdict) {
        row.level = own.verdict->level;
        row.headline = own.verdict->headline;
        if (!own.verdict->but.empty()) row.headline += ". " + own.verdict->but;
        row.seen_mean = own.verdict->seen_mean;
    }
    return row;
}

/// The folder's name, where that says anything.
std::string title_of(const std::filesystem::path& out) {
    const std::string name = (out.filename().empty() ? out.parent_path() : out).filename().string();
    return name == "out" ? "A tray" : name;
}

io::ViewerPlace top_of(const VoxelGrid& grid) {
    const Eigen::Vector3d size = grid.pitch_mm.cwiseProduct(Eigen::Vector3d(grid.size[0], grid.size[1], grid.size[2]));
    io::ViewerPlace place;
    place.at_mm = {size.x() / 2, size.y() / 2, size.z()};
    place.normal = {0, -0.5, 0.8660254};
    place.span_mm = 1.3 * size.maxCoeff();
    return place;
}

/// The place that the part's own verdict names, or its top where that names none.
io::ViewerPlace place_of(const ReadyPart& part, const io::Report& own) {
    io::ViewerPlace place = top_of(part.ready->body.grid);
    if (!own.verdict || own.verdict->but.empty() || own.verdict->regions.empty()) return place;
    const io::ReportRegion& worst = own.verdict->regions.front();
    if (worst.good) return place;
    place.at_mm = worst.place_mm, place.normal = worst.normal;
    place.words = worst.place + (worst.from.empty() ? "" : ", seen " + worst.from);
    return place;
}

/// Of the part, and of no printer: those the tray has for all.
std::vector<std::string> own_warnings(const ReadyPart& part, const io::Report& own, const std::string& name) {
    const std::vector<std::string> of_all = part.ready->job.printer.warnings();
    std::vector<std::string> warnings;
    for (const std::string& warning : own.warnings)
        if (std::ranges::find(of_all, warning) == of_all.end()) warnings.push_back(warning_of_part(name, warning));
    return warnings;
}

/// Before all else: someone waits for it.
void tell_what_is_missing(const std::vector<FailedPart>& failed, io::Report& report) {
    std::vector<std::string> names;
    for (const FailedPart& part : failed) {
        names.push_back(part.who());
        report.warnings.push_back(
            named_warning("part-failed", fmt::format("{} is not on the tray: {}", part.who(), part.message)));
    }
    io::ReportVerdict& verdict = report.verdict ? *report.verdict : report.verdict.emplace();
    const std::string missing = fmt::format("Not on the tray: {}", fmt::join(names, ", "));
    verdict.level = io::VerdictLevel::bad;
    verdict.headline = verdict.headline.empty() ? missing : missing + ". " + verdict.headline;
    verdict.sentence = verdict.sentence.empty() ? missing + "." : missing + ". " + verdict.sentence;
}

void add_print(const OpenedJob& job, const io::StackDescription& stack, const VoxelGrid& grid, io::Report& report) {
    report.program_version = io::program_version();
    report.printer_id = job.printer.id;
    report.printer_name = job.printer.name;
    report.pitch_um = stack.pitch_um;
    report.size_px = {stack.size_px[0], stack.size_px[1], stack.layers};
    for (std::size_t axis = 0; axis < 3; ++axis)
        report.size_mm[axis] = grid.size[axis] * grid.pitch_mm[Eigen::Index(axis)];
    for (std::size_t r = 0; r < stack.resins.size(); ++r) {
        const io::StackResin& resin = stack.resins[r];
        report.resins.push_back(
            {job.resins.set.resins[r].name, resin.role, resin.name, resin.rgb, resin.voxels, resin.ml});
        report.body_voxels += resin.voxels;
    }
    report.warnings = job.printer.warnings();
    report.printing = printing_of(job.printer, length_of(grid), stack.layers);
}

/// As it will look, or as was asked where nothing is known of that.
void draw_from_above(const io::ViewerSurface& surface, const std::filesystem::path& file, const Progress& progress) {
    static constexpr View above[] = {View::top};
    constexpr int longest_px = 1600;
    constexpr double most_px_per_mm = 20;
    const Eigen::Vector3f ground = Eigen::Vector3f::Constant(0.35f);
    const auto named = std::ranges::find(surface.looks, surface.expected, &io::ViewerLook::name);
    const io::ViewerLook& look = named == surface.looks.end() ? surface.looks[0] : *named;
    std::vector<Eigen::Vector3d> positions;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    const ColouredSurface drawn = coloured_surface(surface, look, positions, triangles);
    PreviewOptions options;
    options.samples = 2;  // a plan of what stands where: its edges need no more, and of one part it was 3 % of the time
    options.px_per_mm = std::min(most_px_per_mm, fitting_scale(drawn, above, longest_px, options));
    const Preview preview = std::move(render_views(drawn, above, options, &progress)[0]);
    io::write_whole_file(
        file, io::png_bytes(io::encode_over(preview.picture, ground), {options.px_per_mm, options.px_per_mm}));
}

}  // namespace

std::size_t TrayReport::surface_share() const {
    constexpr std::size_t least_bytes = 12'000;
    return std::max(least_bytes, surface_bytes / std::max<std::size_t>(1, copies_));
}

void TrayReport::add(const ReadyPart& part, io::Report own, Progress& progress) {
    if (is_one_body_) {
        of_one_body_ = std::move(own);
        return;
    }
    Entry entry{row_of(part, own),      std::nullopt, place_of(part, own), part.alone, part.ready->body.grid.pitch_mm,
                own.printing.support_ml};
    entry.surface = part.ready->print->viewer_surface(surface_share(), progress);
    entry.row.about = about_part(part.part);
    entry.warnings = own_warnings(part, own, entry.row.name);
    entries_.push_back(std::move(entry));
}

void TrayReport::add_component(const ReadyPart& part, std::optional<io::ViewerSurface> surface) {
    const VoxelGrid& grid = part.grid();
    io::ReportPart row;
    row.name = part.part.name;
    row.about = about_part(part.part);
    row.headline = fmt::format("{}, neither looped nor predicted", name_of(part.part.component->kind));
    if (!part.part.cuts) row.ml = double(part.component->all_voxels()) * grid.voxel_volume_mm3() * 1e-3;
    const std::optional<double> support_ml = part.part.component->is_shape() ? std::optional(0.0) : std::nullopt;
    entries_.push_back({std::move(row), std::move(surface), top_of(grid), part.alone, grid.pitch_mm, support_ml, true});
}

std::vector<Eigen::Vector3d> TrayReport::places(const Entry& entry, int tray) {
    std::vector<Eigen::Vector3d> mm;
    for (const PlacedCopy& copy : entry.copies)
        if (copy.tray == tray)
            mm.emplace_back(entry.pitch_mm.cwiseProduct(Eigen::Vector3d(copy.at[0], copy.at[1], copy.at[2])));
    return mm;
}

std::optional<double> TrayReport::support_of(const std::vector<const Entry*>& entries, int tray) {
    if (entries.empty()) return std::nullopt;  // without pages nobody looked
    double ml = 0;
    for (const Entry* entry : entries)
        for (const PlacedCopy& copy : entry->copies) {
            if (copy.tray != tray) continue;
            if (copy.at[2] > 0 || !entry->support_ml) return std::nullopt;
            ml += *entry->support_ml;
        }
    return ml;
}

std::vector<const TrayReport::Entry*> TrayReport::on(int tray) const {
    std::vector<const Entry*> here;
    for (const Entry& entry : entries_)
        if (!places(entry, tray).empty()) here.push_back(&entry);
    return here;
}

void TrayReport::add_surface(const std::vector<const Entry*>& entries, int tray, io::Report& report,
                             Progress& progress) {
    std::vector<PlacedSurface> placed;
    std::vector<io::ViewerSurface> of_components;
    of_components.reserve(entries.size());
    const auto shown =
        std::ranges::find_if(entries, [](const Entry* entry) { return entry->surface && !entry->is_component; });
    for (const Entry* entry : entries) {
        if (!entry->surface) continue;
        const io::ViewerSurface* surface = &*entry->surface;
        if (entry->is_component && shown != entries.end())
            surface = &of_components.emplace_back(with_looks_of(*surface, *(*shown)->surface));
        placed.push_back({surface, places(*entry, tray)});
    }
    if (placed.empty()) return;
    report.viewer.surface = compose_surfaces(placed);
    const io::ViewerSurface& surface = *report.viewer.surface;
    std::vector<Eigen::Vector3d> positions;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    if (surface.looks.empty()) return;
    ReportViews views(coloured_surface(surface, surface.looks[0], positions, triangles), false, 0, report, progress);
    for (const io::ViewerLook& look : surface.looks)
        if (look.name == surface.asked || look.name == surface.expected)
            views.add(look.name == surface.asked ? "asked for" : "expected",
                      coloured_surface(surface, look, positions, triangles));
}

io::Report TrayReport::of_bodies(const Tray& tray, LayerWatchers& watchers, Progress& progress) const {
    const std::vector<const Entry*> entries = on(tray.number);
    io::Report report;
    report.title = title_of(tray.out);
    add_print(tray.job, tray.stack, tray.grid, report);
    report.printing.support_ml = support_of(entries, tray.number);
    if (!std::ranges::all_of(entries, &Entry::is_component)) {
        std::vector<const io::ReportPart*> rows;
        for (const Entry* entry : entries)
            if (!entry->is_component) rows.push_back(&entry->row);
        report.verdict = tray_verdict(rows);
        report.verdict->good_up_to = tray.job.options.verdict.good;
        report.verdict->bad_above = tray.job.options.verdict.bad;
        report.verdict->viewing_distance_mm = tray.job.options.loop.viewing_distance_mm;
    }
    report.viewer.viewing_distance_mm = tray.job.options.loop.viewing_distance_mm;
    for (const Entry* entry : entries) {
        report.warnings.insert(report.warnings.end(), entry->warnings.begin(), entry->warnings.end());
        const std::vector<Eigen::Vector3d> at_mm = places(*entry, tray.number);
        io::ReportPart row = entry->row;
        row.copies = static_cast<std::uint32_t>(at_mm.size());
        // The parts' pages lie in the folder of the first tray.
        if (tray.number > 0 && !row.page.empty()) row.page = fmt::format("../{}/{}", first_folder_, row.page);
        report.parts.push_back(std::move(row));
        io::ViewerPlace place = entry->worst;
        for (std::size_t axis = 0; axis < 3; ++axis) place.at_mm[axis] += at_mm[0][Eigen::Index(axis)];
        report.viewer.worst.push_back(std::move(place));
    }
    if (!watchers.thumbnails) return report;
    report.layers = watchers.thumbnails->take();
    add_surface(entries, tray.number, report, progress);
    report.viewer.voxels = watchers.voxels->take(voxel_bytes_left(report));
    report.viewer.voxels->layer_file = io::StackDescription{}.pattern;
    return report;
}

void TrayReport::write(const Tray& tray, LayerWatchers& watchers, double seconds, Progress& progress) {
    const bool has_page = of_one_body_ || watchers.thumbnails;
    io::Report report = of_one_body_ ? *std::exchange(of_one_body_, {}) : of_bodies(tray, watchers, progress);
    if (!tray.failed.empty()) tell_what_is_missing(tray.failed, report);
    report.warnings.insert(report.warnings.end(), tray.warnings.begin(), tray.warnings.end());
    report.total_seconds = seconds;
    report.peak_memory_bytes = peak_memory_bytes();
    if (has_page) {
        if (report.viewer.surface && !report.viewer.surface->looks.empty())
            draw_from_above(*report.viewer.surface, tray.out / tray_picture_name, progress);
        write_page(tray.out, report);
    }
    io::write_whole_file(tray.out / report_file::figures, io::report_json(report));
}

}  // namespace voxtone::slicer

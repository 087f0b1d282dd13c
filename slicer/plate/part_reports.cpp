// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/part_reports.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <mutex>
#include <utility>

#include "base/progress_bar.h"
#include "io/files/whole_file.h"
#include "io/layers/stack_folder.h"
#include "io/report/customer_page.h"
#include "io/report/report_json.h"
#include "slicer/part/phase.h"
#include "slicer/part/phase_estimates.h"
#include "slicer/part/report_files.h"
#include "slicer/plans/part_about.h"
#include "slicer/plate/component_surface.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

double seconds_of(const LayerCounts& counts) {
    return counts.solid_s + counts.shell_s + counts.colour_s + counts.screen_s + counts.runs_s;
}

}  // namespace

/// A part that is looked at.
class PartReports::View {
public:
    View(ReadyPart& part, const PlacedCopy& copy) : part_(part), copy_(copy) {}

    [[nodiscard]] ReadyPart& part() { return part_; }
    [[nodiscard]] const PlacedCopy& copy() const { return copy_; }

    /// Most that is held of its layers.
    [[nodiscard]] std::uint64_t bytes() const {
        constexpr std::uint64_t page_bytes = 16'000'000;  // what the page shows of them
        const PreparedJob& ready = *part_.ready;
        const bool predicts = ready.plan.prediction.by != PredictionPlan::By::nothing;
        return page_bytes + (predicts ? bytes_of_voxels(ready.job, ready.body, ready.plan.layers) : 0);
    }

    [[nodiscard]] LayerSink sink() {
        const PreparedJob& ready = *part_.ready;
        const LayerRange& range = ready.plan.layers;
        watchers_.watch(range, ready.plan.grid, ready.job);
        ready.print->expect_layers(range);
        return [this](int k, const io::LayerRuns& layer) {
            count_resins(layer);
            watchers_.take_layer(k, layer);
            part_.ready->print->take_layer(k, layer);
        };
    }

    void set_figures(const LayerCounts& counts, const JobMeasurements& made) {
        JobMeasurements& figures = part_.ready->figures;
        figures.counts = counts;
        figures.layers_s = made.layers_s;
        figures.encode_s = made.encode_s;
        figures.layer_bytes = made.layer_bytes;
    }

    /// `is_all`: the tray is this body alone, its page the tray's.
    void write(bool is_all, TrayReport& tray, Progress& progress) {
        PreparedJob& ready = *part_.ready;
        io::StackDescription stack = ready.job.describe(ready.plan.grid, ready.plan.layers);
        for (std::size_t r = 0; r < stack.resins.size(); ++r) {
            stack.resins[r].voxels = voxels_[r + 1];
            stack.resins[r].ml = io::millilitres(voxels_[r + 1], stack.pitch_um);
        }
        const WarningsOfPart of_part(progress, ready.body.name.empty() ? part_.part.name : ready.body.name);
        ready.print->evaluate(stack, progress);
        progress.begin_stage(name_of(Phase::report), 0);
        io::Report report = make_report(ready.job, ready.body, stack, *ready.print, ready.figures);
        if (!is_all && ready.body.name.empty()) report.title = part_.part.name;  // whose file may be several parts'
        report.layers = watchers_.thumbnails->take();
        // The layers lie beside the tray's page.
        draw_report(*ready.print, report, watchers_.voxels, is_all ? io::StackDescription{}.pattern : "", progress);
        for (const io::ReportStage& stage : report.stages) report.total_seconds += stage.seconds;
        part_.report = io::report_json(report);
        io::write_whole_file(ready.job.options.out / report_file::figures, part_.report);
        io::write_whole_file(ready.job.options.out / report_file::customer_page,
                             io::customer_html(report, customer_of(part_.part)));
        if (is_all) {
            std::error_code not_there;
            for (const std::string_view name : {report_file::page, report_file::preview, report_file::target_preview})
                fs::remove(ready.job.options.out / name, not_there);  // of a tray that was more
            part_.page = report_file::page;
        } else {
            write_page(ready.job.options.out, report);
            part_.page = (fs::path(io::parts_name) / part_.part.name / report_file::page).generic_string();
        }
        tray.add(part_, std::move(report), progress);
        ready.print->forget_looks();
        progress.end_stage();
    }

private:
    /// In layers that are not written. From any thread.
    void count_resins(const io::LayerRuns& layer) {
        std::array<std::uint64_t, io::max_materials> mine{};
        for (std::uint32_t y = 0; y < layer.height_px(); ++y)
            for (const io::Run& run : layer.row(y)) mine[run.material] += run.length;
        const std::scoped_lock lock(mutex_);
        for (std::size_t m = 0; m < mine.size(); ++m) voxels_[m] += mine[m];
    }

    ReadyPart& part_;
    PlacedCopy copy_;
    LayerWatchers watchers_;
    std::mutex mutex_;
    std::array<std::uint64_t, io::max_materials> voxels_{};
};

TrayReport report_for(const PreparedTray& prepared, const fs::path& out) {
    std::size_t copies = 0;
    for (const ReadyPart& part : prepared.parts.ready) copies += part.alone.size();
    return {copies, folder_of_tray(out, 0).filename().string(), is_one_body(prepared)};
}

PartReports::PartReports(PreparedTray& prepared, int tray, bool wanted) : prepared_(prepared), tray_(tray) {
    if (!wanted) return;
    // The other half is for the white twin and what else predictions take.
    std::uint64_t room = prepared.any_job().options.prediction.memory_bytes / 2;
    for (ReadyPart& part : prepared.parts.ready) {
        if (part.component) {
            if (is_first_seen(part)) components_.push_back(&part);
            continue;
        }
        if (!is_first_seen(part)) continue;
        auto view = std::make_unique<View>(part, *std::ranges::find(part.alone, tray, &PlacedCopy::tray));
        const std::uint64_t bytes = view->bytes();
        const bool fits = now_.empty() || bytes <= room;
        room -= std::min(room, fits ? bytes : 0);
        (fits ? now_ : later_).push_back(std::move(view));
    }
}

bool PartReports::is_first_seen(const ReadyPart& part) const {
    const auto first = std::ranges::min_element(part.alone, {}, &PlacedCopy::tray);
    return first != part.alone.end() && first->tray == tray_;
}

PartReports::~PartReports() = default;

PartSinks PartReports::sinks() {
    PartSinks sinks;
    for (const auto& view : now_) sinks.emplace(&view->part(), view->sink());
    return sinks;
}

void PartReports::write(const ComposedLayers& layers, const JobMeasurements& made, TrayReport& tray,
                        Progress& progress) {
    const std::vector<LayerCounts> counts = layers.counted();
    double all_s = 0;
    for (const LayerCounts& one : counts) all_s += seconds_of(one);
    const bool is_all = is_one_body(prepared_);
    for (const auto& view : now_) {
        // Copies stand in the order of the parts.
        std::size_t first = 0;
        for (const ReadyPart& part : prepared_.parts.ready) {
            if (&part == &view->part()) break;
            first += std::size_t(std::ranges::count(part.alone, tray_, &PlacedCopy::tray));
        }
        JobMeasurements own = made;
        if (!is_all) {
            own = {};
            own.layers_s = all_s > 0 ? made.layers_s * seconds_of(counts[first]) / all_s : 0;
        }
        view->set_figures(counts[first], own);
        view->write(is_all, tray, progress);
    }
    now_.clear();
    for (const ReadyPart* part : components_)
        tray.add_component(*part, part->part.cuts ? std::nullopt
                                                  : component_surface(*part->component, prepared_.any_job(),
                                                                      tray.surface_share(), progress));
    components_.clear();
    for (const auto& view : later_) write_later(*view, tray, progress);
    later_.clear();
}

void PartReports::write_later(View& view, TrayReport& tray, Progress& progress) const {
    const JobBody& body = view.part().ready->body;
    const int first = view.copy().at[2];
    const ComposedLayers alone(
        prepared_.places.trays[std::size_t(tray_)],
        {{view.part().ready->print->layers(), view.copy().at, 0, view.part().part.cuts, view.sink()}});
    LayerWatchers nobody;
    JobMeasurements made;
    make_layers(
        alone, {first, first + body.grid.size[2] - 1}, [](int, const io::LayerRuns&) {}, nobody, made, progress);
    made.encode_s = 0;  // nothing is written
    view.set_figures(alone.counted()[0], made);
    view.write(false, tray, progress);
}

}  // namespace voxtone::slicer

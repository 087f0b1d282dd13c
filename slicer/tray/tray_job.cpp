// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/tray/tray_job.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "base/peak_memory.h"
#include "base/progress_bar.h"
#include "base/stop_deadline.h"
#include "base/stopwatch.h"
#include "io/files/json_object.h"
#include "io/files/json_writer.h"
#include "io/files/sha256.h"
#include "io/files/whole_file.h"
#include "io/layers/layer_stack_writer.h"
#include "io/layers/stack_folder.h"
#include "slicer/job/job_phases.h"
#include "slicer/kept/loop_checkpoint.h"
#include "slicer/kept/report_files.h"
#include "slicer/layers/composed_layers.h"
#include "slicer/printer/placement.h"
#include "slicer/tray/joined_parts.h"
#include "slicer/tray/tray_parts.h"
#include "slicer/tray/tray_report.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

/// What decides the stack: the parts' jobs and the places of their copies.
std::string identity_of(const std::vector<ReadyPart>& parts) {
    std::string text = "voxtone tray 1\n";
    for (const ReadyPart& part : parts) {
        text +=
            fmt::format("{} {} {} {}\n", part.part.name, part.ready->identity.job, part.part.priority, part.part.cuts);
        for (const std::array<int, 3>& at : part.at) text += fmt::format("{} {} {}\n", at[0], at[1], at[2]);
    }
    return io::sha256({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

/// Of the tray that OUT holds; empty: none, or one that cannot be read.
std::string identity_in(const fs::path& out) {
    try {
        return io::JsonObject::read(out / tray_file_name).text("identity");
    } catch (const Error&) {
        return {};
    }
}

/// The appearance loop of a part, which is kept for the next time.
void rearrange(ReadyPart& part, Progress& progress) {
    Print& print = *part.ready->print;
    print.prepare(progress);
    print.rearrange(progress);
    (void)print.keep_loop();
    LoopCheckpoint::remove_from(part.ready->job.options.out);
    set_stop_advice({});
}

/// Voxels of each resin in layers that are not written.
class ResinCounter {
public:
    explicit ResinCounter(std::size_t resins) : voxels_(resins + 1) {}
    /// From any thread.
    void add(const io::LayerRuns& layer) {
        std::vector<std::uint64_t> mine(voxels_.size());
        for (std::uint32_t y = 0; y < layer.height_px(); ++y)
            for (const io::Run& run : layer.row(y)) mine[run.material] += run.length;
        const std::scoped_lock lock(mutex_);
        for (std::size_t m = 0; m < mine.size(); ++m) voxels_[m] += mine[m];
    }
    void fill_in(io::StackDescription& stack) const {
        for (std::size_t r = 0; r < stack.resins.size(); ++r) {
            stack.resins[r].voxels = voxels_[r + 1];
            stack.resins[r].ml = io::millilitres(voxels_[r + 1], stack.pitch_um);
        }
    }

private:
    std::mutex mutex_;
    std::vector<std::uint64_t> voxels_;
};

/// Predicts the part alone and writes its report: its layers are made for that, and not written.
void report_part(ReadyPart& part, io::StackDescription stack, TrayReport& tray, Progress& progress) {
    const Stopwatch watch;
    PreparedJob& ready = *part.ready;
    LayerWatchers watchers;
    const LayerRange& range = ready.plan.layers;
    watchers.thumbnails.emplace(range.first, range.layers(), ready.plan.grid, ready.job.palette());
    watchers.voxels.emplace(range.first, range.layers(), ready.plan.grid);
    ResinCounter resins(stack.resins.size());
    make_layers(
        *ready.print, range, [&](int, const io::LayerRuns& layer) { resins.add(layer); }, watchers, ready.figures,
        progress);
    resins.fill_in(stack);
    ready.print->look(stack, progress);
    progress.begin_stage(name_of(Phase::report), 0);
    io::Report report = make_report(ready.job, ready.body, stack, *ready.print, ready.figures);
    report.layers = watchers.thumbnails->take();
    part.report = write_report(ready.job, *ready.print, report, watchers.voxels, watch, progress);
    tray.add(part, report, progress);
    ready.print->forget_looks();
    progress.end_stage();
}

ComposedLayers compose(const std::vector<ReadyPart>& parts, const VoxelGrid& grid) {
    std::vector<PlacedPart> placed;
    for (const ReadyPart& part : parts) {
        if (part.alone.empty()) continue;
        const std::shared_ptr<const LayerSource> layers = part.ready->print->layers();
        for (const std::array<int, 3>& at : part.alone)
            placed.push_back({layers, at, part.part.priority, part.part.cuts});
    }
    return {grid, std::move(placed)};
}

void write_layers(const ComposedLayers& layers, io::LayerStackWriter& writer, LayerWatchers& watchers,
                  Progress& progress) {
    const int count = layers.grid().size[2], depth = layers.slab_layers();
    progress.begin_stage(name_of(Phase::layers), std::uint64_t(count), "layers");
    parallel_for(
        0, std::size_t((count + depth - 1) / depth), 1,
        [&](std::size_t slab) {
            (void)layers.make(int(slab), 0, count, [&](int k, const io::LayerRuns& layer) {
                progress.check_cancelled();
                writer.write(std::uint32_t(k), layer);
                watchers.see(k, layer);
                progress.advance();
            });
        },
        &progress);
    progress.end_stage();
}

/// mm3 that a part would have filled and another one has, by copy.
std::vector<double> overlaps_mm3(const std::vector<ReadyPart>& parts, const ComposedLayers& layers,
                                 Progress& progress) {
    const std::vector<std::uint64_t> lost = layers.overlapped(0, layers.grid().size[2]);
    std::vector<double> mm3;
    std::size_t at = 0;
    for (const ReadyPart& part : parts) {
        std::uint64_t voxels = 0;
        for (std::size_t copy = 0; copy < part.alone.size(); ++copy) voxels += lost[at++];
        mm3.push_back(double(voxels) * layers.grid().voxel_volume_mm3());
        if (voxels > 0)
            progress.note(
                fmt::format("{}: {:.1f} mm3 of it lie where another part is printed (\"priority\" says whose "
                            "voxels they are)",
                            part.part.name, mm3.back()));
    }
    return mm3;
}

/// tray.json: what stands where, and what became of it.
std::string tray_json(const std::vector<ReadyPart>& parts, const std::vector<double>& lost_mm3,
                      const io::StackDescription& stack, const VoxelGrid& grid) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-tray-stack").add("version", 1).add("identity", identity_of(parts));
    json.add("content_sha256", stack.content_sha256).add("layers", stack.layers).key("parts").begin_list();
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const ReadyPart& part = parts[p];
        const VoxelGrid& own = part.ready->body.grid;
        json.line().begin_object().add("name", part.part.name).add("model", part.ready->job.options.model);
        if (part.is_joined) json.add("joined", true);
        json.add("priority", part.part.priority).add("cuts", part.part.cuts).add("size_px", own.size);
        json.key("at_px").begin_list();
        for (const std::array<int, 3>& at : part.at) json.value(at);
        json.end_list().key("at_mm").begin_list();
        for (const std::array<int, 3>& at : part.at) {
            const Eigen::Vector3d mm = grid.pitch_mm.cwiseProduct(Eigen::Vector3d(at[0], at[1], at[2]));
            json.value(std::array{mm.x(), mm.y(), mm.z()});
        }
        json.end_list().add("overlapped_mm3", lost_mm3[p] + parts[p].shared_mm3 * double(parts[p].alone.size()));
        if (!part.report.empty()) {
            json.add("report", (fs::path(io::parts_name) / part.part.name / report_file::page).generic_string());
            const io::JsonObject report = io::JsonObject::parse(part.report, "report");
            if (report.has("verdict") && report.is_object("verdict"))
                json.add("verdict", report.object("verdict").text("level"));
        }
        json.end_object();
    }
    json.end_list().end_object();
    return json.text();
}

std::string summary(const TrayPlan& plan, const std::vector<ReadyPart>& parts, const io::StackDescription& stack,
                    double seconds) {
    std::string text = fmt::format("{}: {:.2f} x {:.2f} x {:.2f} mm, {} x {} px, {} layers of {:g} um\n",
                                   plan.common.out, stack.size_mm[0], stack.size_mm[1], stack.size_mm[2],
                                   stack.size_px[0], stack.size_px[1], stack.layers, stack.pitch_um[2]);
    for (const ReadyPart& part : parts)
        text += fmt::format("  {:<20} {}\n", part.part.name,
                            part.part.copies == 1 ? "once" : fmt::format("{} copies", part.part.copies));
    for (const io::StackResin& resin : stack.resins)
        text += fmt::format("  {:<3} {:<16} {:9.3f} ml\n", resin.role, resin.name, resin.ml);
    text += fmt::format("  done in {}; peak memory {:.0f} MB\n", duration_text(seconds),
                        double(peak_memory_bytes()) * 1e-6);
    if (plan.common.report)
        text += fmt::format("  report: {}\n", (fs::path(plan.common.out) / report_file::page).string());
    return text;
}

}  // namespace

JobResult run_tray_job(const TrayPlan& plan, Progress& progress) {
    const Stopwatch watch;
    const fs::path out = plan.common.out;
    if (out.empty()) throw UsageError("tray: name the folder for the print (-o OUT)");
    std::vector<std::string_view> companions(report_file::all.begin(), report_file::all.end());
    companions.push_back(tray_file_name);
    io::StackFolder folder(out, std::move(companions));
    // A strange folder is refused before anything is made in it; whose stack is there is known once the parts are.
    if (!plan.common.overwrite && !folder.holds_stack()) folder.expect_free();
    const ThreadLimit threads(static_cast<std::size_t>(plan.common.threads));
    std::vector<ReadyPart> parts = prepare_parts(plan, progress);
    const VoxelGrid grid = arrange(parts, plan.gap_mm);
    join_near_parts(parts, out, progress);
    const OpenedJob& first = parts[0].ready->job;
    for (const std::string& warning : first.printer.warnings()) progress.warn(warning);
    check_layer_count(grid.size[2], first.printer, "larger (\"size\")");
    if (folder.holds_stack() && identity_in(out) == identity_of(parts) && !plan.common.overwrite) {
        std::vector<std::uint8_t> json = io::read_whole_file(out / tray_file_name, std::uint64_t{1} << 30);
        return {{json.begin(), json.end()},
                fmt::format("{}: holds this tray already, whole; nothing was done (--overwrite makes it again)\n",
                            out.string()),
                ExitCode::done};
    }
    if (!plan.common.overwrite) folder.expect_free();

    const LayerRange all{0, grid.size[2] - 1};
    io::LayerStackWriter writer(std::move(folder), first.describe(grid, all), first.outputs());
    std::size_t copies = 0;
    for (const ReadyPart& part : parts) copies += part.alone.size();
    TrayReport report(copies);
    for (ReadyPart& part : parts) {
        if (part.alone.empty()) continue;
        progress.note(fmt::format("part {}", part.part.name));
        rearrange(part, progress);
        const LayerRange& range = part.ready->plan.layers;
        if (plan.common.report) report_part(part, first.describe(part.ready->plan.grid, range), report, progress);
    }
    const ComposedLayers layers = compose(parts, grid);
    LayerWatchers watchers;
    if (plan.common.report) {
        watchers.thumbnails.emplace(0, grid.size[2], grid, first.palette());
        watchers.voxels.emplace(0, grid.size[2], grid);
    }
    write_layers(layers, writer, watchers, progress);
    const std::vector<double> lost_mm3 = overlaps_mm3(parts, layers, progress);
    progress.begin_stage(name_of(Phase::finish), 0);
    const io::StackDescription stack = writer.finish({}, &progress);
    std::string json = tray_json(parts, lost_mm3, stack, grid);
    io::write_whole_file(out / tray_file_name, json);
    if (plan.common.report) report.write(out, first, stack, grid, watchers, watch.total(), progress);
    progress.end_stage();
    return {std::move(json), summary(plan, parts, stack, watch.total()), ExitCode::done};
}

}  // namespace voxtone::slicer

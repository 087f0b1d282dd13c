// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/job/slice_job.h"

#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <system_error>

#include <fmt/core.h>

#include "voxtone/base/parallel.h"
#include "voxtone/base/stopwatch.h"
#include "voxtone/io/files/whole_file.h"
#include "voxtone/io/layers/layer_stack_writer.h"
#include "voxtone/io/layers/layer_thumbnail.h"
#include "voxtone/io/models/model_reader.h"
#include "voxtone/slicer/job/job_body.h"
#include "voxtone/slicer/job/job_colour.h"
#include "voxtone/slicer/job/job_layers.h"
#include "voxtone/slicer/job/job_loop.h"
#include "voxtone/slicer/job/job_prediction.h"
#include "voxtone/slicer/job/layer_surfaces.h"
#include "voxtone/slicer/job/layers_report.h"
#include "voxtone/slicer/job/print_parts.h"
#include "voxtone/slicer/job/slice_report.h"
#include "voxtone/slicer/layers/layer_maker.h"
#include "voxtone/slicer/look/upright_cut.h"
#include "voxtone/slicer/options/model_choice.h"

namespace voxtone::slicer {

namespace {

io::StackDescription describe(const PrinterProfile& printer, const LoadedResins& resins, const VoxelGrid& grid,
                              const LayerRange& range) {
    io::StackDescription stack;
    stack.printer = printer.id;
    stack.pitch_um = {printer.pitch_um.x(), printer.pitch_um.y(), printer.pitch_um.z()};
    stack.size_px = {std::uint32_t(grid.size[0]), std::uint32_t(grid.size[1])};
    stack.layers = std::uint32_t(range.last - range.first + 1);
    stack.first_layer = std::uint32_t(range.first);
    stack.origin_mm = {grid.origin_mm.x(), grid.origin_mm.y(), grid.origin_mm.z()};
    stack.background_rgb = printer.background_rgb;
    stack.resins = resins.entries;
    return stack;
}

io::StackOutputs outputs_of(const SliceOptions& options, const PrinterProfile& printer) {
    io::StackOutputs outputs;
    for (const std::string& format : options.formats.empty() ? printer.formats : options.formats) {
        if (format == "gcvf") outputs.gcvf = true;
        if (format == "vdb") outputs.vdb = true;
        if (format == "tiff") outputs.resin_bitmaps = io::ResinBitmaps::tiff1;
        if (format == "png1") outputs.resin_bitmaps = io::ResinBitmaps::png1;
    }
    return outputs;
}

/// Pictures of some layers for the report, evenly spaced from the first to the last.
class Thumbnails {
public:
    Thumbnails(const LayerRange& range, const VoxelGrid& grid, std::vector<io::Rgb> palette, bool wanted)
        : range_(range),
          grid_(grid),
          palette_(std::move(palette)),
          count_(wanted ? std::min(most, range.last - range.first + 1) : 0) {}

    void offer(int k, const io::LayerRuns& layer) {
        if (count_ == 0 || layer_of(slot_of(k)) != k) return;
        constexpr std::uint32_t longest_px = 560;
        const io::LinearPicture picture =
            io::layer_thumbnail(layer, palette_, {grid_.pitch_mm.x(), grid_.pitch_mm.y()}, longest_px);
        const io::Picture8 codes = io::encode_transparent(picture);
        io::ReportLayer entry;
        entry.number = std::uint32_t(k);
        entry.height_mm = (k + 0.5) * grid_.pitch_mm.z();
        const double longest_mm = std::max(grid_.size[0] * grid_.pitch_mm.x(), grid_.size[1] * grid_.pitch_mm.y());
        entry.picture = {"", io::png_bytes(codes), codes.width_px, codes.height_px, longest_px / longest_mm};
        const std::scoped_lock lock(mutex_);
        entries_[k] = std::move(entry);
    }
    [[nodiscard]] std::vector<io::ReportLayer> take() {
        std::vector<io::ReportLayer> layers;
        for (auto& [k, entry] : entries_) layers.push_back(std::move(entry));
        return layers;
    }

private:
    static constexpr int most = 48;
    [[nodiscard]] int layers() const { return range_.last - range_.first + 1; }
    [[nodiscard]] int slot_of(int k) const {
        return static_cast<int>((std::int64_t(k - range_.first) * count_ + layers() - 1) / layers());
    }
    [[nodiscard]] int layer_of(int slot) const {
        return range_.first + static_cast<int>(std::int64_t(slot) * layers() / count_);
    }

    LayerRange range_;
    VoxelGrid grid_;
    std::vector<io::Rgb> palette_;
    int count_;
    std::mutex mutex_;
    std::map<int, io::ReportLayer> entries_;
};

/// Reports of an earlier job in this folder do not describe this one.
void remove_old_report(const std::filesystem::path& folder) {
    for (const char* name : {"job.json", "report.json", "report.html", "target.png", "predicted.png", "difference.png",
                             "open-loop.png", "target.exr", "predicted.exr", "target.glb", "predicted.glb"}) {
        std::error_code not_there;
        std::filesystem::remove(folder / name, not_there);
    }
}

std::vector<std::array<float, 3>> single_precision(const std::vector<Eigen::Vector3d>& positions) {
    std::vector<std::array<float, 3>> out;
    out.reserve(positions.size());
    for (const Eigen::Vector3d& p : positions) out.push_back({float(p.x()), float(p.y()), float(p.z())});
    return out;
}

/// Nothing, with a warning, where it needs more memory than allowed: the print is whole without it.
std::optional<JobPrediction> predict_or_warn(const SliceOptions& options, PredictionPlan& plan, const JobBody& body,
                                             const LoadedResins& resins, JobVolume& volume, const JobLoop* loop,
                                             Progress& progress) {
    try {
        if (auto whole = volume.finish()) {
            if (plan.model == loop_prediction) return prediction_of_loop(*loop, std::move(*whole));
            JobPrediction prediction = predict_job(options, plan.model, body, resins, std::move(*whole), progress);
            if (loop) prediction.open_loop = loop->result.state.open;
            return prediction;
        }
        plan.why_not = volume.why_not();
    } catch (const ResourceError& error) {
        plan.why_not = error.what();
    }
    plan.why_not = "The print is not predicted: " + plan.why_not + ".";
    progress.warn(plan.why_not);
    return std::nullopt;
}

/// Null, with the reason, where there is no loop: the open loop is printed then.
std::unique_ptr<const JobLoop> rearrange(const SliceOptions& options, const JobBody& body, const LoadedResins& resins,
                                         const JobColour& colour, const PrintParts& parts,
                                         const std::filesystem::path& folder, std::string& why_not,
                                         Progress& progress) {
    const LoopPlan plan = plan_loop(options, body, resins);
    why_not = plan.why_not;
    if (plan.iterations == 0) {
        if (!why_not.empty()) progress.note(why_not);
        return nullptr;
    }
    try {
        return std::make_unique<const JobLoop>(options, plan, body, resins, colour, parts, folder, progress);
    } catch (const ResourceError& error) {
        why_not = fmt::format("The resins were not rearranged: {}.", error.what());
        progress.warn(why_not);
        return nullptr;
    }
}

/// A picture without a size of its own is as wide as the map.
SliceOptions with_map_width(const SliceOptions& options, const io::ProfileMap& map) {
    SliceOptions sized = options;
    if (!io::is_model_name(options.model) && options.width_mm == 0) sized.width_mm = map.width_mm;
    return sized;
}

std::unique_ptr<const JobLayers> wrap_layers(const SliceOptions& options, io::ProfileMap map, const JobBody& body,
                                             const LoadedResins& resins, Progress& progress) {
    auto layers = std::make_unique<const JobLayers>(options, std::move(map), body, resins, progress);
    for (const std::string& warning : layers->warnings) progress.warn(warning);
    if (options.resume)
        progress.note("--resume: layered profiles have no loop to go on with; the job begins at its start");
    return layers;
}

std::unique_ptr<const PrintParts> print_parts(const SliceOptions& options, const JobBody& body,
                                              const LoadedResins& resins, const JobColour* colour,
                                              const JobLayers* layers, const Progress& progress) {
    if (layers) return std::make_unique<const PrintParts>(options, body, resins, layers->wrapped());
    return std::make_unique<const PrintParts>(options, body, resins, *colour, progress);
}

}  // namespace

SliceResult run_slice_job(const SliceOptions& given, Progress& progress) {
    Stopwatch watch;
    JobFigures figures;
    validate(given);
    std::optional<io::ProfileMap> map;
    if (given.layered()) map = io::read_profile_map(given.profiles);
    const SliceOptions options = map ? with_map_width(given, *map) : given;
    const ThreadLimit threads(static_cast<std::size_t>(options.threads));
    const PrinterProfile printer = find_printer(options.printer);
    const LoadedResins resins = load_resins(options, printer);
    for (const std::string& warning : printer.warnings()) progress.warn(warning);

    const JobBody body = prepare_body(options, printer, progress);
    for (const std::string& warning : body.warnings) progress.warn(warning);
    progress.note(body.placement.summary);
    const LayerRange range = parse_layer_range(options.layers, body.grid.size[2]);
    figures.read_s = body.read_s;
    figures.repair_s = watch.lap() - body.read_s;

    const auto colour = map ? nullptr
                            : prepare_colour(options, resins, body.grid.pitch_mm,
                                             body.is_picture ? body.placement.extent_mm.z() : 0, progress);
    const auto layers = map ? wrap_layers(options, std::move(*map), body, resins, progress) : nullptr;
    figures.separation_s = watch.lap();

    io::LayerStackWriter writer(options.out, describe(printer, resins, body.grid, range), outputs_of(options, printer),
                                options.overwrite);
    remove_old_report(options.out);

    const auto parts = print_parts(options, body, resins, colour.get(), layers.get(), progress);
    std::string why_no_loop;
    const auto loop =
        colour ? rearrange(options, body, resins, *colour, *parts, writer.folder(), why_no_loop, progress) : nullptr;
    figures.loop_s = watch.lap();
    const LayerMaker maker(parts->sources(loop ? loop->skin() : nullptr));
    std::vector<io::Rgb> palette{printer.background_rgb};
    for (const io::StackResin& resin : resins.entries) palette.push_back(resin.rgb);
    Thumbnails thumbnails(range, body.grid, palette, options.report);

    std::optional<UprightCut> cut;
    if (layers && options.report) cut.emplace(body.grid, range.first, range.last, body.grid.size[1] / 2);

    // The volume and its white twin are held at once.
    std::optional<JobVolume> volume;
    const bool reusable = loop && resins.set.channels.wavelengths_nm.empty();
    PredictionPlan plan;
    if (colour)
        plan = plan_prediction(options, body, range.first == 0 && range.last + 1 == body.grid.size[2], reusable);
    if (!plan.model.empty()) volume.emplace(body.grid, memory_budget(options.memory_gib) / 2);

    std::mutex figures_mutex;
    progress.begin_stage("layers", std::uint64_t(range.last - range.first + 1), "layers");
    const int first_slab = range.first / maker.slab_layers(), last_slab = range.last / maker.slab_layers();
    parallel_for(
        std::size_t(first_slab), std::size_t(last_slab) + 1, 1,
        [&](std::size_t slab) {
            double encode_s = 0;
            const LayerCounts counts =
                maker.make(int(slab), range.first, range.last + 1, [&](int k, const io::LayerRuns& layer) {
                    progress.check_cancelled();
                    Stopwatch encode;
                    writer.write(std::uint32_t(k - range.first), layer);
                    encode_s += encode.total();
                    thumbnails.offer(k, layer);
                    if (volume) volume->add(k, layer);
                    if (cut) cut->add(k, layer);
                    progress.advance();
                });
            const std::scoped_lock lock(figures_mutex);
            figures.counts += counts;
            figures.encode_s += encode_s;
        },
        &progress);
    progress.end_stage();
    figures.layers_s = watch.lap();

    progress.begin_stage("finish", 0);
    const auto preview = single_precision(body.solid->positions_mm);
    const io::StackDescription& stack = writer.finish({preview, body.solid->triangles}, &progress);
    io::write_whole_file(writer.folder() / "job.json", job_json(options));
    figures.layer_bytes = writer.bytes_written();
    figures.layers = thumbnails.take();
    if (cut)
        figures.cut = cut->picture(
            palette, "cut through the middle of the print along x, upright; resins as the bitmaps colour them");
    figures.finish_s = watch.lap();
    figures.total_s = watch.total();
    std::vector<SurfaceFile> surfaces;
    if (layers && options.surfaces) {
        progress.end_stage();
        surfaces = write_layer_surfaces(layer_surfaces(body, layers->wrapped(), options.surface_cell_mm, progress),
                                        resins, stack, writer.folder());
        progress.begin_stage("report", 0);
    }
    std::optional<JobPrediction> prediction;
    if (volume) {
        progress.end_stage();
        prediction = predict_or_warn(options, plan, body, resins, *volume, loop.get(), progress);
        progress.begin_stage("report", 0);
    }
    const ReportSources sources{options,
                                printer,
                                resins,
                                body,
                                colour.get(),
                                layers.get(),
                                parts->surface_colour(),
                                stack,
                                prediction ? &*prediction : nullptr,
                                plan.why_not,
                                loop.get(),
                                why_no_loop,
                                palette,
                                surfaces};
    io::Report report = make_report(sources, figures);
    if (options.report) {
        draw_report(sources, report, writer.folder(), progress);
        io::write_whole_file(writer.folder() / "report.html", io::report_html(report));
    }
    const std::string json = io::report_json(report);
    io::write_whole_file(writer.folder() / "report.json", json);
    progress.end_stage();
    return {json, summary_text(sources, report, figures, writer.folder())};
}

}  // namespace voxtone::slicer

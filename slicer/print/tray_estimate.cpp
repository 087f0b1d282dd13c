// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/tray_estimate.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/parallel.h"
#include "base/process_usage.h"
#include "base/progress_bar.h"
#include "base/stopwatch.h"
#include "io/disk/disk_space.h"
#include "slicer/part/phase_estimates.h"
#include "slicer/plate/component.h"
#include "slicer/plate/kept_loop.h"
#include "slicer/plate/opened_tray.h"
#include "slicer/printer/placement.h"

namespace voxtone::slicer {

namespace {

/// Of what the layers of a part take: of each further copy (its rows are screened anew, its mixtures are not found
/// again), by `slice` of 1 and 20 copies of the bundled cow at 20 mm (docs/decisions/015): 0.10 s of a
/// processor each, where the layers of one take some 0.4.
constexpr double share_of_copy = 0.25;

struct EstimatedPart {
    const TrayPart* part;
    std::optional<MeasuredBody> measured{};  ///< nothing: a component
    std::optional<PrinterProfile> printer{};
    std::optional<ReadyComponent> component{};
    JobEstimate estimate = {};
    std::uint64_t resident_bytes = 0;  ///< when it was estimated
    std::uint64_t copy_bytes = 0;      ///< on disk, of each further copy
};

/// Nothing is looped or predicted. A stack's layers take what reading it has taken now.
EstimatedPart estimate_component(const TrayPart& part, const OpenedJob& common, Progress& progress) {
    // 1.5 s of processors for six copies of a stack of 22 million voxels, 1.6 s for a mixture of 129 million.
    constexpr double cpu_s_of_voxel = 1.1e-8;
    const Stopwatch watch;
    const double cpu_began_s = cpu_seconds();
    EstimatedPart made{&part};
    made.component = prepare_component(part, common, progress);
    const VoxelGrid& grid = made.component->layers->grid();
    const double voxel_ml = grid.voxel_volume_mm3() * 1e-3, voxels = double(made.component->all_voxels());
    JobEstimate& estimate = made.estimate;
    ResinVolumes volumes;
    for (const std::uint64_t count : made.component->voxels)
        volumes.ml.push_back(part.cuts ? 0 : double(count) * voxel_ml), volumes.body_ml += volumes.ml.back();
    add_amounts(common, volumes, estimate);
    estimate.disk_bytes = made.copy_bytes = component_disk_bytes(*made.component, part.cuts, common);
    PhaseEstimate read{Phase::read, cpu_seconds() - cpu_began_s, watch.total(), peak_memory_bytes(), true};
    PhaseEstimate layers{Phase::layers, read.cpu_s + voxels * cpu_s_of_voxel, 0, resident_bytes(), false};
    layers.seconds = seconds_on_threads(layers.cpu_s, thread_count());
    estimate.phases = {read, layers};
    made.resident_bytes = resident_bytes();
    return made;
}

EstimatedPart estimate_part(const TrayPart& part, const EstimateScope& scope, const OpenedJob* common,
                            Progress& progress) {
    progress.note("part " + part.name);  // whose the unit is that comes now
    if (part.component) return estimate_component(part, *common, progress);
    const OpenedJob job = open_job(part.options, [&](const OpenedJob& opened, JobRun& run) {
        run.loop_done =
            part.job && !part.job->folder.empty() && why_no_kept_loop(part.job->folder, opened, progress).empty();
    });
    EstimatedPart made{&part};
    made.printer = job.printer;
    made.measured.emplace(read_measured(job, progress));
    made.resident_bytes = resident_bytes();
    const JobBody& body = made.measured->body;
    made.copy_bytes = disk_bytes_of_copy(job, body, range_within(job.options.layers, body.grid.size[2]));
    made.estimate = estimate_body(job, made.measured->body, made.measured->read, scope, progress);
    return made;
}

void add_resins(const JobEstimate& part, int copies, JobEstimate& sum) {
    sum.body_ml += copies * part.body_ml;
    if (!part.why_no_resins.empty()) sum.why_no_resins = part.why_no_resins;
    for (const ResinEstimate& resin : part.resins) {
        auto found = std::ranges::find(sum.resins, resin.role, &ResinEstimate::role);
        if (found == sum.resins.end()) {
            sum.resins.push_back({resin.role, resin.name, 0, resin.g ? std::optional(0.0) : std::nullopt,
                                  resin.price ? std::optional(0.0) : std::nullopt});
            found = sum.resins.end() - 1;
        }
        found->ml += copies * resin.ml;
        if (found->g && resin.g) *found->g += copies * *resin.g;
        if (found->price && resin.price) *found->price += copies * *resin.price;
    }
    sum.currency = part.currency;
}

void add_phases(const EstimatedPart& part, std::uint64_t resident_in_the_end, JobEstimate& sum) {
    const double copies = 1 + (part.measured ? share_of_copy : 1) * (part.part->copies - 1);
    for (PhaseEstimate phase : part.estimate.phases) {
        if (phase.phase == Phase::layers) phase.cpu_s *= copies, phase.seconds *= copies;
        // The bodies of all parts are held while each is worked on.
        phase.memory_bytes += resident_in_the_end - std::min(resident_in_the_end, part.resident_bytes);
        const auto found = std::ranges::find(sum.phases, phase.phase, &PhaseEstimate::phase);
        if (found == sum.phases.end()) {
            sum.phases.push_back(phase);
            continue;
        }
        found->cpu_s += phase.cpu_s;
        found->seconds += phase.seconds;
        found->memory_bytes = std::max(found->memory_bytes, phase.memory_bytes);
    }
    sum.loop = sum.loop || part.estimate.loop;
    sum.prediction = sum.prediction || part.estimate.prediction;
    sum.loop_s += part.estimate.loop_s;
}

/// Nothing where one stands above others, or what it is made of is not known.
std::optional<double> support_of(const std::vector<EstimatedPart>& parts, const Arrangement& places) {
    double ml = 0;
    for (std::size_t p = 0; p < parts.size(); ++p) {
        for (const PlacedCopy& copy : places.copies[p])
            if (copy.at[2] > 0) return std::nullopt;
        const bool is_shape = parts[p].component && parts[p].part->component->is_shape();
        if (!is_shape && !parts[p].estimate.support_ml) return std::nullopt;
        ml += parts[p].part->copies * parts[p].estimate.support_ml.value_or(0);
    }
    return ml;
}

void add_print(const Arrangement& places, const PrinterProfile& printer, JobEstimate& sum) {
    const VoxelGrid& grid = places.trays[0];
    sum.printer = printer.id;
    sum.layer_um = grid.pitch_mm.z() * 1e3;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        sum.size_px[axis] = std::uint32_t(grid.size[axis]);
        sum.size_mm[axis] = grid.size[axis] * grid.pitch_mm[Eigen::Index(axis)];
    }
    for (const VoxelGrid& tray : places.trays) {
        check_layer_count(tray.size[2], printer, "larger (\"size\")");
        sum.layers += std::uint32_t(tray.size[2]);
        sum.printing.add(printer.sliced_passes(), length_of(tray), std::uint64_t(tray.size[2]));
    }
    if (places.trays.size() > 1) sum.notes.push_back(fmt::format("{} trays are filled", places.trays.size()));
    sum.notes.insert(sum.notes.end(), places.notes.begin(), places.notes.end());
}

}  // namespace

JobEstimate estimate_tray(const SliceOptions& asked, const TrayModels& models, Progress& progress,
                          const EstimateScope& scope) {
    if (scope.orientations)
        throw UsageError(
            "--orientations is a table of one body; name its model alone, and neither others nor the plan of a tray");
    SliceOptions options = asked;
    if (options.out.empty()) options.out = ".";
    const OpenedTray tray = models.empty() ? open_tray(options) : open_tray_of_models(options, models);
    const SliceOptions& common = tray.plan.common;
    const ThreadLimit threads(static_cast<std::size_t>(common.threads));
    const std::optional<OpenedJob> of_all = common_job(tray.plan);
    std::vector<EstimatedPart> parts;
    EstimateScope of_part = scope;
    of_part.of_a_tray = true;
    std::vector<FailedPart> failed;
    for (const TrayPart& part : tray.plan.parts)
        (void)goes_well(part, common.fail_fast, failed, progress,
                        [&] { parts.push_back(estimate_part(part, of_part, of_all ? &*of_all : nullptr, progress)); });
    expect_some(failed, parts.size());
    std::vector<StandingPart> standing;
    for (const EstimatedPart& part : parts)
        standing.push_back(
            {part.part, part.measured ? &part.measured->body : nullptr, part.component ? &*part.component : nullptr});
    const PrinterProfile printer = of_all ? of_all->printer : *parts[0].printer;
    JobEstimate sum;
    sum.model = models.empty() ? asked.model : fmt::format("{}", fmt::join(models.files, ", "));
    sum.threads = thread_count();
    sum.warnings = printer.warnings();
    for (const FailedPart& part : failed) {
        sum.warnings.push_back(failed_warning(part));
        sum.faults.push_back(part.message);
    }
    if (!failed.empty()) sum.exit_code = failed.front().exit_code;
    const Arrangement places =
        arrange(standing, printer.sliced_tray_mm(), tray_options_of(common), printer.sliced_passes());
    add_print(places, printer, sum);
    sum.support_ml = support_of(parts, places);
    const std::uint64_t resident = resident_bytes();
    double g = 0, price = 0;
    bool weighed = true, priced = true;
    for (const EstimatedPart& part : parts) {
        add_resins(part.estimate, part.part->copies, sum);
        add_phases(part, resident, sum);
        sum.surface_mm2 += part.part->copies * part.estimate.surface_mm2;
        sum.disk_bytes += part.estimate.disk_bytes + std::uint64_t(part.part->copies - 1) * part.copy_bytes;
        weighed = weighed && part.estimate.g, priced = priced && part.estimate.price;
        g += part.part->copies * part.estimate.g.value_or(0);
        price += part.part->copies * part.estimate.price.value_or(0);
        if (!part.measured) continue;
        for (const std::string& warning : part.measured->body.warnings)
            sum.warnings.push_back(warning_of_part(part.part->name, warning));
    }
    if (weighed) sum.g = g;
    if (priced) sum.price = price;
    for (const PhaseEstimate& phase : sum.phases) {
        sum.cpu_s += phase.cpu_s;
        sum.seconds += phase.seconds;
        sum.memory_bytes = std::max(sum.memory_bytes, phase.memory_bytes);
    }
    sum.free_disk_bytes = io::free_disk_bytes(options.out);
    return sum;
}

}  // namespace voxtone::slicer

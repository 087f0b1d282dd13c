// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/estimate_job.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "base/process_usage.h"
#include "base/stopwatch.h"
#include "base/warning.h"
#include "io/disk/disk_space.h"
#include "slicer/look/air_under.h"
#include "slicer/part/resin_choice.h"
#include "slicer/print/orientations.h"
#include "slicer/printer/placement.h"

namespace voxtone::slicer {

namespace {

/// Measures how the model is read and repaired.
class Reading {
public:
    [[nodiscard]] PhaseEstimate finish() const {
        // The program that reads works beside this one.
        return {Phase::read, cpu_seconds() - cpu_began_s_, watch_.total(),
                peak_memory_bytes() + peak_child_memory_bytes(), true};
    }

private:
    Stopwatch watch_;
    double cpu_began_s_ = cpu_seconds();
};

/// What a job makes of colours, made once.
struct MadeColours {
    std::unique_ptr<const JobColour> colour;
    std::unique_ptr<const halftone::MinimalDepthSeparation> recipes;  ///< of the loop
};

MadeColours make_colours(const PlannedPrint& planned, Progress& progress) {
    const OpenedJob& job = planned.job;
    MadeColours made;
    made.colour = prepare_colour(job.options.colour, job.resins, planned.body.grid.pitch_mm,
                                 slab_under_colour(job.options, planned.body), progress);
    if (!planned.plan.loop.wanted) return made;
    const optics::ShellAppearance& appearance = made.colour->appearance;
    made.recipes = prepare_recipes(appearance, halftone::skin_layers(appearance.geometry().shell_mm));
    return made;
}

/// Of a print whose resins are not known.
void add_volume(const OpenedJob& job, const JobBody& body, const LayerRange& range, const Progress& progress,
                JobEstimate& estimate) {
    VolumeQuery query;
    query.layers = range;
    query.keep_thin = job.options.keep_thin;
    estimate.body_ml = resin_volumes(body, query, progress).body_ml;
    estimate.why_no_resins =
        job.other ? job.other->why_no_resins() : "Which resins they are was not asked for (--quick).";
}

/// What nobody asked and everybody should know.
void add_remarks(const PlannedPrint& planned, JobEstimate& estimate) {
    estimate.warnings = planned.job.printer.warnings();
    estimate.warnings.insert(estimate.warnings.end(), planned.body.warnings.begin(), planned.body.warnings.end());
    if (!planned.plan.loop.does_not_fit.empty())
        estimate.warnings.push_back(named_warning("loop-left-out", planned.plan.loop.does_not_fit));
    estimate.notes = planned.body.notes;
    if (!planned.job.why_these_resins.empty()) estimate.notes.push_back(planned.job.why_these_resins);
}

void add_sums(JobEstimate& estimate) {
    for (const PhaseEstimate& phase : estimate.phases) {
        estimate.cpu_s += phase.cpu_s;
        estimate.seconds += phase.seconds;
        estimate.memory_bytes = std::max(estimate.memory_bytes, phase.memory_bytes);
    }
}

}  // namespace

void add_amounts(const OpenedJob& job, const ResinVolumes& volumes, JobEstimate& estimate) {
    constexpr double kg_per_g = 1e-3;
    estimate.body_ml = volumes.body_ml;
    double g = 0, price = 0;
    bool weighed = true, priced = true;
    for (std::size_t r = 0; r < job.resins.entries.size(); ++r) {
        const optics::Resin& resin = job.resins.set.resins[r];
        ResinEstimate amount{job.resins.entries[r].role, job.resins.entries[r].name, volumes.ml[r], {}, {}};
        if (resin.density_g_per_ml) amount.g = amount.ml * *resin.density_g_per_ml;
        if (amount.g && resin.price_per_kg) amount.price = *amount.g * kg_per_g * *resin.price_per_kg;
        weighed = weighed && amount.g, priced = priced && amount.price;
        g += amount.g.value_or(0), price += amount.price.value_or(0);
        estimate.resins.push_back(std::move(amount));
    }
    if (weighed) estimate.g = g;
    if (priced) estimate.price = price;
    estimate.currency = job.resins.set.currency;
}

JobEstimate estimate_print(const PlannedPrint& planned, const PhaseEstimate& read, const ColourRecipes* made_with,
                           const Progress& progress) {
    const auto& [job, body, plan] = planned;
    JobEstimate estimate;
    estimate.model = job.options.model;
    estimate.printer = job.printer.id;
    estimate.size_mm = {body.placement.extent_mm.x(), body.placement.extent_mm.y(), body.placement.extent_mm.z()};
    for (std::size_t axis = 0; axis < 3; ++axis)
        estimate.size_px[axis] = static_cast<std::uint32_t>(plan.grid.size[axis]);
    estimate.first_layer = static_cast<std::uint32_t>(plan.layers.first);
    estimate.layers = static_cast<std::uint32_t>(plan.layers.layers());
    estimate.layer_um = plan.grid.pitch_mm.z() * 1e3;
    estimate.surface_mm2 = coloured_area_mm2(*body.surface);
    estimate.printing.add(job.printer.sliced_passes(), body.placement.extent_mm, estimate.layers);
    if (made_with)
        add_amounts(job, colour_volumes(job, body, plan.layers, *made_with, progress), estimate);
    else
        add_volume(job, body, plan.layers, progress, estimate);

    estimate.threads = thread_count();
    estimate.loop = plan.loop.wanted;
    estimate.phases = {read};
    estimate.phases.insert(estimate.phases.end(), plan.phases.begin(), plan.phases.end());
    for (const PhaseEstimate& phase : plan.phases) {
        if (phase.phase == Phase::prepare_loop || phase.phase == Phase::loop) estimate.loop_s += phase.seconds;
        estimate.prediction = estimate.prediction || phase.phase == Phase::predict;
    }
    add_sums(estimate);
    estimate.disk_bytes = plan.disk_bytes;
    estimate.free_disk_bytes = io::free_disk_bytes(job.options.out);
    add_remarks(planned, estimate);
    return estimate;
}

JobEstimate estimate_body(const OpenedJob& opened, const JobBody& body, const PhaseEstimate& read,
                          const EstimateScope& scope, Progress& progress) {
    const OpenedJob job = scope.resins ? with_best_resins(opened, body, progress) : opened;
    const JobPlan plan = plan_job(job, body);
    // As the job would; what is turned otherwise may be printed all the same.
    if (!plan.loop.does_not_fit.empty()) throw ResourceError(plan.loop.does_not_fit);
    if (!scope.orientations && !scope.of_a_tray) check_layer_count(plan.grid.size[2], job.printer, enough_layers(body));
    const PlannedPrint planned{job, body, plan};
    std::optional<MadeColours> made;
    if (!job.other && scope.resins) made = make_colours(planned, progress);
    std::optional<ColourRecipes> made_with;
    if (made) made_with.emplace(ColourRecipes{made->colour->appearance, made->colour->separation, made->recipes.get()});
    JobEstimate estimate = estimate_print(planned, read, made_with ? &*made_with : nullptr, progress);
    if (plan.all_layers) estimate.support_ml = look_under(*body.solid).ml;
    if (scope.orientations) {
        estimate.orientations = orientations(job, body, progress);
        estimate.advised_orientation = advised_orientation(estimate.orientations, estimate.surface_mm2);
    }
    return estimate;
}

MeasuredBody read_measured(const OpenedJob& job, Progress& progress) {
    Reading reading;
    JobBody body = prepare_body(job.options, job.printer, progress);
    say_body(body, progress);
    return {std::move(body), reading.finish()};
}

JobEstimate estimate_job(const SliceOptions& asked, Progress& progress, const EstimateScope& scope) {
    SliceOptions options = asked;
    if (options.out.empty()) options.out = ".";
    const OpenedJob job = open_job(options);
    const ThreadLimit threads(static_cast<std::size_t>(job.options.threads));
    const MeasuredBody measured = read_measured(job, progress);
    return estimate_body(job, measured.body, measured.read, scope, progress);
}

}  // namespace voxtone::slicer

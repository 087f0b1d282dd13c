// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/plan_estimate.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/counted.h"
#include "base/error.h"
#include "base/machine_memory.h"
#include "base/progress_bar.h"
#include "io/disk/disk_space.h"
#include "io/files/json_writer.h"
#include "slicer/print/run_print.h"

namespace voxtone::farm {

namespace {

/// What a resin adds up to; weight and price only where every job that takes it knows them.
struct ResinTotal {
    double ml = 0, g = 0, price = 0;
    bool weighed = true, priced = true;
};

struct Totals {
    std::size_t estimated = 0, failed = 0;
    double ml = 0, cpu_s = 0, seconds = 0;
    std::uint64_t memory_bytes = 0;  ///< the most that one job takes
    std::uint64_t disk_bytes = 0;
    std::optional<std::uint64_t> free_disk_bytes;
    std::size_t threads = 0;                                           ///< most of a job
    std::map<std::pair<std::string, std::string>, ResinTotal> resins;  ///< by role and name
    std::map<std::string, double> price;                               ///< by currency
    std::size_t without_price = 0, without_resins = 0;                 ///< jobs
};

void add_resins(Totals& totals, const slicer::JobEstimate& estimate) {
    if (estimate.resins.empty()) ++totals.without_resins;
    for (const slicer::ResinEstimate& resin : estimate.resins) {
        ResinTotal& total = totals.resins[{resin.role, resin.name}];
        total.ml += resin.ml;
        total.g += resin.g.value_or(0);
        total.price += resin.price.value_or(0);
        total.weighed = total.weighed && resin.g;
        total.priced = total.priced && resin.price;
    }
    if (estimate.price)
        totals.price[estimate.currency] += *estimate.price;
    else
        ++totals.without_price;
}

Totals totals_of(const std::vector<PlannedEstimate>& jobs) {
    Totals totals;
    for (const PlannedEstimate& job : jobs) {
        if (!job.fault.empty()) {
            ++totals.failed;
            continue;
        }
        const slicer::JobEstimate& estimate = job.estimate;
        ++totals.estimated;
        totals.ml += estimate.body_ml;
        totals.cpu_s += estimate.cpu_s;
        totals.seconds += estimate.seconds;
        totals.memory_bytes = std::max(totals.memory_bytes, estimate.memory_bytes);
        totals.disk_bytes += estimate.disk_bytes;
        totals.free_disk_bytes = estimate.free_disk_bytes;
        totals.threads = std::max(totals.threads, estimate.threads);
        add_resins(totals, estimate);
    }
    return totals;
}

void write_job(io::JsonWriter& json, const PlannedEstimate& job) {
    json.line().begin_object().add("job", job.job).add("model", job.model);
    if (!job.fault.empty()) {
        json.add("exit_code", job.exit_code).add("message", job.fault).end_object();
        return;
    }
    const slicer::JobEstimate& estimate = job.estimate;
    json.add("size_mm", estimate.size_mm).add("layers", estimate.layers).add("ml", estimate.body_ml);
    if (estimate.g) json.add("g", *estimate.g);
    if (estimate.price) json.add("price", *estimate.price).add("currency", estimate.currency);
    json.key("resins").begin_list();
    for (const slicer::ResinEstimate& resin : estimate.resins)
        json.begin_object().add("role", resin.role).add("name", resin.name).add("ml", resin.ml).end_object();
    json.end_list().add("cpu_seconds", estimate.cpu_s).add("seconds", estimate.seconds);
    json.add("threads", estimate.threads).add("memory_bytes", estimate.memory_bytes);
    json.add("disk_bytes", estimate.disk_bytes).add("warnings", estimate.warnings).end_object();
}

void write_totals(io::JsonWriter& json, const Totals& totals) {
    json.line().key("totals").begin_object().add("estimated", totals.estimated).add("failed", totals.failed);
    json.add("ml", totals.ml).key("resins").begin_list();
    for (const auto& [resin, total] : totals.resins) {
        json.begin_object().add("role", resin.first).add("name", resin.second).add("ml", total.ml);
        if (total.weighed) json.add("g", total.g);
        if (total.priced) json.add("price", total.price);
        json.end_object();
    }
    json.end_list().key("prices").begin_list();
    for (const auto& [currency, price] : totals.price)
        json.begin_object().add("currency", currency).add("price", price).end_object();
    json.end_list().add("jobs_without_price", totals.without_price).add("jobs_without_resins", totals.without_resins);
    json.add("cpu_seconds", totals.cpu_s).add("seconds", totals.seconds);
    json.add("most_memory_bytes", totals.memory_bytes).add("disk_bytes", totals.disk_bytes);
    if (totals.free_disk_bytes) json.add("free_disk_bytes", *totals.free_disk_bytes);
    json.end_object();
}

std::string line_of(const PlannedEstimate& job, std::size_t widest) {
    if (!job.fault.empty()) return fmt::format("  {:<{}}  cannot be sliced: {}\n", job.job, widest, job.fault);
    const slicer::JobEstimate& e = job.estimate;
    std::string text = fmt::format("  {:<{}}  {:>22} {:>6} layers {:>9.3f} ml {:>12} {:>10}", job.job, widest,
                                   fmt::format("{:.1f} x {:.1f} x {:.1f} mm", e.size_mm[0], e.size_mm[1], e.size_mm[2]),
                                   e.layers, e.body_ml, duration_text(e.seconds), memory_text(e.memory_bytes));
    if (e.price) text += fmt::format(" {:>8.2f} {}", *e.price, e.currency);
    if (!e.warnings.empty()) text += "  " + counted(e.warnings.size(), "warning");
    return text + "\n";
}

std::string price_text(const Totals& totals) {
    std::string text;
    for (const auto& [currency, price] : totals.price)
        text += fmt::format("{}{:.2f} {}", text.empty() ? "" : " and ", price, currency);
    if (!text.empty() && totals.without_price > 0)
        text += fmt::format(", without {} whose resins have no price", counted(totals.without_price, "job"));
    return text;
}

std::string totals_text(const Totals& totals) {
    std::string text = fmt::format("all {}: {:.3f} ml\n", counted(totals.estimated, "job"), totals.ml);
    for (const auto& [resin, total] : totals.resins) {
        text += fmt::format("  {:<3} {:<16} {:9.3f} ml", resin.first, resin.second, total.ml);
        if (total.weighed) text += fmt::format("  {:9.3f} g", total.g);
        text += "\n";
    }
    if (totals.without_resins > 0)
        text += fmt::format("  of {} it is not known which resins the layers take\n",
                            counted(totals.without_resins, "job"));
    if (const std::string price = price_text(totals); !price.empty()) text += fmt::format("  cost: {}\n", price);
    text += fmt::format("  time: {} one after the other on {}; {} of processors\n", duration_text(totals.seconds),
                        counted(totals.threads, "thread"), duration_text(totals.cpu_s));
    text += fmt::format("  memory: {} for the one that takes most; disk: up to {}", memory_text(totals.memory_bytes),
                        io::bytes_text(totals.disk_bytes));
    if (totals.free_disk_bytes) text += fmt::format(" ({} free)", io::bytes_text(*totals.free_disk_bytes));
    return text + "\n";
}

PlannedEstimate estimate_planned(const PlannedJob& job, const slicer::EstimateScope& scope, Progress& progress) {
    PlannedEstimate planned{job.name, job.options.model, {}, {}, 0};
    slicer::SliceOptions requested = job.options;
    requested.overwrite = true;  // what its folder holds does not matter here
    try {
        planned.estimate = slicer::estimate_print({requested}, progress, scope);
        planned.exit_code = static_cast<int>(planned.estimate.exit_code);
    } catch (const Cancelled&) {
        throw;
    } catch (const TryAgain&) {
        throw;
    } catch (const Error& error) {
        planned.fault = error.what();
        planned.exit_code = static_cast<int>(error.exit_code());
    }
    return planned;
}

}  // namespace

std::string plan_estimate_json(const std::vector<PlannedEstimate>& jobs) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-plan-estimate").add("version", 1).line().key("jobs").begin_list();
    for (const PlannedEstimate& job : jobs) write_job(json, job);
    json.end_list();
    write_totals(json, totals_of(jobs));
    return json.end_object().text();
}

std::string plan_estimate_text(const std::vector<PlannedEstimate>& jobs) {
    std::size_t widest = 0;
    for (const PlannedEstimate& job : jobs) widest = std::max(widest, job.job.size());
    std::string text;
    for (const PlannedEstimate& job : jobs) text += line_of(job, widest);
    const Totals totals = totals_of(jobs);
    if (totals.estimated > 0) text += totals_text(totals);
    if (totals.failed > 0) text += fmt::format("{} cannot be sliced\n", counted(totals.failed, "job"));
    return text;
}

JobResult run_plan_estimate(const PlanOptions& plan, const slicer::EstimateScope& scope, Progress& progress) {
    std::vector<PlannedEstimate> jobs;
    ExitCode code = ExitCode::done;
    for (const PlannedJob& job : read_plan(plan, &progress)) {
        progress.check_cancelled();
        jobs.push_back(estimate_planned(job, scope, progress));
        if (code == ExitCode::done) code = static_cast<ExitCode>(jobs.back().exit_code);
    }
    return {plan_estimate_json(jobs), plan_estimate_text(jobs), code};
}

}  // namespace voxtone::farm

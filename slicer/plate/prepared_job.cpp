// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/prepared_job.h"

#include <string>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "base/warning.h"
#include "io/disk/disk_space.h"
#include "slicer/colour/colour_print.h"
#include "slicer/part/resin_choice.h"
#include "slicer/part/skin_file.h"

namespace voxtone::slicer {

namespace {

JobBody read_body(const OpenedJob& job, JobMeasurements& figures, Progress& progress) {
    const Stopwatch watch;
    JobBody body = prepare_body(job.options, job.printer, progress);
    say_body(body, progress);
    figures.read_s = body.read_s;
    figures.repair_s = watch.total() - body.read_s;
    return body;
}

JobIdentity identify_said(const OpenedJob& job, const JobBody& body, Progress& progress) {
    JobIdentity identity = identify(job, body.side_files, &progress);
    for (const std::string& changed : changed_inputs(job.options.raw.recorded_inputs, identity.inputs))
        progress.warn(named_warning("changed-input", changed));
    return identity;
}

OpenedJob choose_said(OpenedJob opened, const JobBody& body, Progress& progress) {
    OpenedJob job = with_best_resins(std::move(opened), body, progress);
    if (!job.why_these_resins.empty()) progress.note(job.why_these_resins);
    return job;
}

std::unique_ptr<Print> make_print(const OpenedJob& job, const JobBody& body, const JobIdentity& identity,
                                  const JobPlan& plan, Progress& progress) {
    if (job.other) return job.other->make(job, body, progress);
    return std::make_unique<ColourPrint>(job, body, identity, plan, progress);
}

}  // namespace

PreparedJob::PreparedJob(OpenedJob opened, std::optional<JobBody> kept, Progress& progress)
    : body(kept ? *std::move(kept) : read_body(opened, figures, progress)),
      identity(identify_said(opened, body, progress)),
      job(choose_said(std::move(opened), body, progress)),
      plan(plan_job(job, body)),
      print(make_print(job, body, identity, plan, progress)) {}

void expect_own_loop(const OpenedJob& job, const Progress* progress) {
    const ResolvedJob& options = job.options;
    const bool is_replaced = options.overwrite && !job.run.loop_elsewhere && !options.loop.mixtures_named;
    if (options.loop.iterations == 0 || is_replaced) return;
    if (options.until == Until::loop && options.overwrite) return;
    if (std::error_code none; !std::filesystem::exists(options.loop.mixtures, none)) return;
    SkinFile::expect_same_job(options.loop.mixtures, opened_loop_identity(job, progress), options.loop);
}

void expect_disk_space(const std::filesystem::path& out, std::uint64_t needed_bytes, Progress& progress) {
    if (const std::optional<std::uint64_t> free = io::free_disk_bytes(out))
        progress.note(fmt::format("the stack takes up to {} of the {} that the disk of {} has free",
                                  io::bytes_text(needed_bytes), io::bytes_text(*free), out.string()));
    io::expect_disk_space(out, needed_bytes, "the stack and its report");
}

}  // namespace voxtone::slicer

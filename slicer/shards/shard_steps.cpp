// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/shards/shard_steps.h"

#include <chrono>
#include <filesystem>
#include <thread>

#include <fmt/core.h>

#include "base/error.h"
#include "base/process_usage.h"
#include "io/disk/folder_lock.h"
#include "io/files/json_writer.h"
#include "io/layers/stack_folder.h"
#include "io/programs/build_identity.h"
#include "slicer/job/prepared_job.h"
#include "slicer/options/job_file.h"

namespace voxtone::slicer {

namespace fs = std::filesystem;

std::string shard_program() { return "voxtone " + io::build_identity(); }

ShardTask task_of(const OpenedJob& job, bool same_job_before) {
    if (job.options.shard) return {*job.options.shard, 1};
    return task_of_scheduler(same_job_before ? job.options.out : fs::path());
}

void expect_shardable(const OpenedJob& job) {
    const io::StackOutputs outputs = job.outputs();
    if (outputs.vdb)
        throw UsageError(fmt::format(
            "--shard: {} is one file of the whole stack, which shards do not make: leave it out of --formats, or slice "
            "without --shard",
            io::vdb_name));
}

JobResult shard_result(const io::ShardRecord& record, const fs::path& out, const char* what) {
    const std::string range =
        record.layers == 0 ? "no layers: there are more shards than slabs of layers"
                           : fmt::format("layers {} to {}", record.first_layer, record.first_layer + record.layers - 1);
    const fs::path file = io::shard_file(out, record.number);
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-shard-done").add("version", 1).add("record", file.string());
    json.add("shard", record.number.shard).add("of", record.number.of).add("first_layer", record.first_layer);
    json.add("layers", record.layers).add("seconds", record.figures.total_s).end_object();
    return {json.text(), fmt::format("{}: {}{}\n", file.string(), range, what), ExitCode::done};
}

/// The same job's stack, whole: what shards are made for.
std::optional<JobResult> merged_before(const OpenedJob& job, const Progress& progress) {
    const fs::path& out = job.options.out;
    if (job.options.overwrite || !fs::exists(out / io::manifest_name) || !is_same_job(out, job, &progress))
        return std::nullopt;
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-shard-done").add("version", 1).add("merged", out.string()).end_object();
    return JobResult{json.text(),
                     fmt::format("{}: holds this job's stack already, whole; nothing was done (--overwrite makes the "
                                 "shard again)\n",
                                 out.string()),
                     ExitCode::done};
}

/// This very shard, with every file.
std::optional<io::ShardRecord> made_before(const OpenedJob& job, const io::ShardNumber& number) {
    const fs::path &out = job.options.out, folder = io::shards_folder(out), file = io::shard_file(out, number);
    if (job.options.overwrite || !fs::exists(file)) return std::nullopt;
    try {
        io::ShardRecord record = io::read_shard(file);
        if (record.number != number || record.program != shard_program() || record.job != recorded_identity(folder) ||
            io::missing_file(record, folder / io::shard_store(record.job)))
            return std::nullopt;
        return record;
    } catch (const Error&) {
        return std::nullopt;  // it is made again
    }
}

/// The first of the shards that take a folder over from another job clears it, and no other: those that begin at the
/// same time wait, and then find it theirs.
void claim_folder_for_shards(const OpenedJob& job, io::ShardFolder& folder, const std::string& job_text,
                             const Progress& progress) {
    const fs::path shards = io::shards_folder(job.options.out);
    constexpr int tries = 600;
    constexpr std::chrono::milliseconds between(50);
    std::optional<io::FolderLock> lock;
    for (int attempt = 1; !lock; ++attempt) {
        try {
            lock.emplace(shards);
        } catch (const io::FolderHeld&) {
            if (attempt == tries) throw;
            progress.check_cancelled();
            std::this_thread::sleep_for(between);
        }
    }
    if (!job.options.overwrite)
        expect_no_other_shards(job, &progress);  // one may have come while this one read its model
    else if (!is_same_job(shards, job, &progress))
        io::remove_shards(job.options.out);
    folder.claim(job_text);
}

io::ShardFigures shard_figures(const JobMeasurements& f, const Stopwatch& since_begin) {
    return {.body_voxels = f.counts.body_voxels,
            .shell_voxels = f.counts.shell_voxels,
            .thin_voxels = f.counts.thin_voxels,
            .solid_s = f.counts.solid_s,
            .shell_s = f.counts.shell_s,
            .colour_s = f.counts.colour_s,
            .screen_s = f.counts.screen_s,
            .runs_s = f.counts.runs_s,
            .encode_s = f.encode_s,
            .layers_s = f.layers_s,
            .total_s = since_begin.total(),
            .peak_memory_bytes = peak_memory_bytes()};
}

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/cluster/folder_words.h"

#include <filesystem>
#include <system_error>

#include "base/error.h"
#include "farm/batch/job_result.h"
#include "io/layers/stack_folder.h"
#include "io/shards/shard_folder.h"
#include "slicer/part/job_identity.h"
#include "slicer/part/skin_file.h"

namespace voxtone::farm {

namespace {

namespace fs = std::filesystem;

bool is_there(const fs::path& file) {
    std::error_code none;
    return fs::exists(file, none);
}

bool skin_is_foreign(const slicer::OpenedJob& job, const Progress& progress) {
    try {
        slicer::SkinFile::expect_same_job(job.options.loop.mixtures, slicer::opened_loop_identity(job, &progress),
                                          job.options.loop);
        return false;
    } catch (const InputError&) {
        return true;
    }
}

bool holds_anothers(const fs::path& out, const slicer::OpenedJob& job, bool makes_loop, const Progress& progress) {
    if (is_there(out / io::manifest_name) && !slicer::is_same_job(out, job, &progress)) return true;
    const fs::path shards = io::shards_folder(out);
    if (is_there(shards / io::job_file_name) && !slicer::is_same_job(shards, job, &progress)) return true;
    if (!makes_loop) return false;
    // Of a loop that waits here it is known that it is another's.
    return is_there(out / io::checkpoint_name) || (is_there(out / io::skin_name) && skin_is_foreign(job, progress));
}

}  // namespace

std::vector<std::string> words_for_folder(TaskStage stage, const PlannedJob& job, bool ours, const Progress& progress) {
    const bool makes_loop = stage == TaskStage::whole || stage == TaskStage::prepare;
    if (makes_loop && waits_to_go_on(job.out, job)) return {"--resume"};
    if (!ours || is_missing_or_empty(job.out)) return {};
    if (holds_anothers(job.out, slicer::open_job(job.options), makes_loop, progress)) return {"--overwrite"};
    return {};
}

}  // namespace voxtone::farm

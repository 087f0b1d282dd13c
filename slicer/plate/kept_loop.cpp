// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/kept_loop.h"

#include <filesystem>

#include <fmt/core.h>

#include "base/error.h"
#include "io/files/whole_file.h"
#include "io/layers/stack_folder.h"
#include "slicer/part/skin_file.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

fs::path kept_in(const std::string& folder) { return fs::path(folder) / io::skin_name; }

}  // namespace

std::string why_no_kept_loop(const std::string& folder, const OpenedJob& job, const Progress& progress) {
    if (std::error_code none; !fs::exists(kept_in(folder), none))
        return fmt::format(
            "{} kept nothing of its own (`slice --until loop` and shards do; its finished voxels are a "
            "\"stack\")",
            folder);
    try {
        SkinFile::expect_same_job(kept_in(folder), opened_loop_identity(job, &progress), job.options.loop);
        return {};
    } catch (const TryAgain&) {
        throw;
    } catch (const Error& error) {  // of another job, or broken
        return error.what();
    }
}

bool take_kept_loop(const std::string& name, const std::string& folder, const OpenedJob& job, Progress& progress) {
    if (job.options.loop.iterations == 0) return false;
    if (const std::string why = why_no_kept_loop(folder, job, progress); !why.empty()) {
        progress.note(fmt::format("{}: the appearance loop is run again: {}", name, why));
        return false;
    }
    constexpr std::uint64_t most_bytes = std::uint64_t{1} << 34;
    const fs::path own = job.options.out / io::skin_name;
    fs::create_directories(own.parent_path());
    io::write_whole_file(own, io::read_whole_file(kept_in(folder), most_bytes));
    return true;
}

bool is_loop_of(const std::string& name, const PreparedJob& ready, Progress& progress) {
    const JobLoopOptions& loop = ready.job.options.loop;
    if (SkinFile(loop.mixtures, ready.identity.opened_loop, ready.identity.loop, loop).is_of_this_job()) return true;
    progress.note(
        fmt::format("{}: the appearance loop is run again: a file beside the model holds something else than when "
                    "it was run",
                    name));
    return false;
}

}  // namespace voxtone::slicer

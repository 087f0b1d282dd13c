// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/job_result.h"

#include <ctime>
#include <system_error>

#include <fmt/core.h>

#include "base/error.h"
#include "io/files/file_digest.h"
#include "io/files/json_object.h"
#include "io/files/whole_file.h"
#include "io/layers/stack_folder.h"
#include "io/report/report_picture.h"
#include "slicer/options/job_file.h"
#include "slicer/part/job_identity.h"
#include "slicer/part/loop_checkpoint.h"
#include "slicer/part/report_files.h"

namespace voxtone::farm {

namespace {

namespace fs = std::filesystem;

std::vector<slicer::JobInput> noted_inputs(const fs::path& folder) {
    slicer::SliceOptions noted;
    slicer::read_job((folder / slicer::job_file_name).string(), noted);
    return noted.recorded_inputs;
}

std::string absolute(const std::string& file) { return fs::absolute(file).lexically_normal().string(); }

}  // namespace

bool is_missing_or_empty(const fs::path& folder) {
    std::error_code error;
    return !fs::exists(folder, error) || fs::is_empty(folder, error);
}

std::int64_t now_ns() {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

StackFigures read_job_figures(const fs::path& folder) {
    const io::JsonObject report = io::JsonObject::read(folder / slicer::report_file::figures);
    const io::JsonObject manifest = io::JsonObject::read(folder / io::manifest_name);
    StackFigures figures;
    figures.content_sha256 = manifest.text("content_sha256");
    figures.printer = report.object("printer").text("id");
    read_shared_figures(report, figures);
    for (const io::JsonObject& resin : report.objects("resins"))
        figures.resin_ml.emplace_back(resin.text("role"), resin.number("ml", 0, 1e12));
    if (report.has("verdict")) {
        const io::JsonObject verdict = report.object("verdict");
        if (verdict.has("seen_de2000")) {
            figures.verdict = verdict.text("level");
            figures.seen_de2000 = verdict.object("seen_de2000").number("mean", 0, 1e3);
        }
    }
    return figures;
}

void learn_inputs(const fs::path& folder, std::int64_t began_ns, io::FileDigests& digests) {
    constexpr std::int64_t coarse_ns = 2'000'000'000;  // as io::FileStamp::settled
    for (const slicer::JobInput& input : noted_inputs(folder)) {
        if (input.file.empty() || input.sha256.empty()) continue;
        const std::string file = absolute(input.file);
        if (const auto stamp = io::FileStamp::of(file); stamp && stamp->changed_ns + coarse_ns < began_ns)
            digests.learn(file, {*stamp, input.sha256});
    }
}

std::vector<std::pair<std::string, io::KnownDigest>> known_inputs(const fs::path& folder,
                                                                  const io::FileDigests& digests) {
    std::vector<std::pair<std::string, io::KnownDigest>> known;
    for (const slicer::JobInput& input : noted_inputs(folder)) {
        if (input.file.empty()) continue;
        const std::string file = absolute(input.file);
        if (const auto found = digests.find(file); found && found->sha256 == input.sha256)
            known.emplace_back(file, *found);
    }
    return known;
}

void write_job_picture(const fs::path& folder, const fs::path& file) {
    constexpr std::uint64_t most_bytes = std::uint64_t{64} << 20;
    constexpr std::uint32_t most_px = 96;
    const fs::path preview = folder / slicer::report_file::preview;
    std::error_code none;
    if (!fs::exists(preview, none)) return;
    io::write_whole_file(file, io::small_picture_png(io::read_whole_file(preview, most_bytes), most_px));
}

std::string take_stack(const fs::path& folder, std::int64_t began_ns, const fs::path& picture, JobState& state) {
    state.figures = read_job_figures(folder);
    learn_inputs(folder, began_ns, io::file_digests());
    state.inputs = known_inputs(folder, io::file_digests());
    try {
        write_job_picture(folder, picture);
    } catch (const Error& error) {
        return fmt::format("its small picture could not be made: {}", error.what());
    }
    return {};
}

bool holds_job(const fs::path& folder, const PlannedJob& job, const Progress* progress) {
    std::error_code none;
    if (!fs::exists(folder / io::manifest_name, none) || !fs::exists(folder / slicer::report_file::figures, none) ||
        fs::exists(folder / io::checkpoint_name, none))
        return false;
    try {
        return slicer::is_same_job(folder, slicer::open_job(job.options), progress);
    } catch (const Cancelled&) {
        throw;
    } catch (const Error&) {
        return false;  // the job itself will say what is wrong
    }
}

bool waits_to_go_on(const fs::path& folder, const PlannedJob& job) {
    std::error_code none;
    if (!fs::exists(folder / io::checkpoint_name, none)) return false;
    try {
        slicer::LoopCheckpoint::expect_same_job(folder, slicer::opened_loop_identity(slicer::open_job(job.options)));
        return true;
    } catch (const Error&) {
        return false;  // it is another job's, or broken
    }
}

}  // namespace voxtone::farm

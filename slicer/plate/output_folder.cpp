// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/output_folder.h"

#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "base/error.h"
#include "base/warning.h"
#include "io/files/whole_file.h"
#include "io/printer/printer_folder.h"
#include "io/shards/shard_folder.h"
#include "slicer/options/job_file.h"
#include "slicer/part/job_identity.h"
#include "slicer/part/report_files.h"

namespace voxtone::slicer {

namespace fs = std::filesystem;

io::StackFolder take_output(const fs::path& out, std::vector<std::string_view> besides, Progress& progress) {
    besides.insert(besides.end(), report_file::all.begin(), report_file::all.end());
    io::StackFolder folder(out, std::move(besides));
    if (!folder.doubt().empty()) progress.warn(named_warning("lock-doubt", folder.doubt()));
    return folder;
}

bool holds_stack_of(const OpenedJob& job, const io::StackFolder& folder, const Progress& progress) {
    return folder.holds_stack() && is_same_job(folder.path(), job, &progress);
}

std::optional<std::string> said_before(const OpenedJob& job, const io::StackFolder& folder, std::string_view name,
                                       const Progress& progress) {
    constexpr std::uint64_t most_bytes = std::uint64_t{1} << 30;
    const fs::path file = folder.path() / name;
    if (!fs::exists(file) || !holds_stack_of(job, folder, progress)) return std::nullopt;
    const std::vector<std::uint8_t> text = io::read_whole_file(file, most_bytes);
    return std::string(text.begin(), text.end());
}

void expect_replaceable(const OpenedJob& job, const io::StackFolder& folder, const Replacing& how, Progress& progress) {
    if (!how.overwrite) {
        if (!how.goes_on && !holds_stack_of(job, folder, progress)) folder.expect_free();
        expect_no_other_shards(folder.path(), job, &progress);
    }
    if (!how.for_printer.empty()) io::expect_printer_target(folder.path(), how.for_printer, how.overwrite);
    say_strangers(folder, progress);
}

void say_strangers(const io::StackFolder& folder, Progress& progress) {
    if (const std::string note = folder.strangers_note(); !note.empty())
        progress.warn(named_warning("strange-files", note));
}

void expect_no_other_shards(const fs::path& out, const OpenedJob& job, const Progress* progress) {
    const fs::path folder = io::shards_folder(out);
    if (std::error_code none; !fs::exists(folder / job_file_name, none)) return;
    if (is_same_job(folder, job, progress)) return;
    throw InputError(
        fmt::format("{}: holds shards of another job, which would be lost: name another folder, merge them first, or "
                    "allow it with --overwrite",
                    folder.string()));
}

}  // namespace voxtone::slicer

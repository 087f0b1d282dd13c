// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a job of a batch has left, read from its files.
#pragma once

#include <cstdint>
#include <filesystem>

#include "base/progress.h"
#include "farm/batch/job_state.h"
#include "farm/batch/plan.h"
#include "io/files/file_digest.h"

namespace voxtone::farm {

/// Now, as file systems have it: nanoseconds since 1970.
[[nodiscard]] std::int64_t now_ns();
/// Where a job finds nothing that it has not made.
[[nodiscard]] bool is_missing_or_empty(const std::filesystem::path& folder);

/// Of the stack and the report in a job's folder. Throws FileError, InputError.
[[nodiscard]] StackFigures read_job_figures(const std::filesystem::path& folder);

/// Teaches `digests` what the inputs held that the job in this folder notes, as far as they were last changed before
/// the job began. Throws FileError, InputError.
void learn_inputs(const std::filesystem::path& folder, std::int64_t began_ns, io::FileDigests& digests);
/// What is known for good of the inputs that the job in this folder notes.
[[nodiscard]] std::vector<std::pair<std::string, io::KnownDigest>> known_inputs(const std::filesystem::path& folder,
                                                                                const io::FileDigests& digests);

/// Writes a small picture of the print, where its job left one.
void write_job_picture(const std::filesystem::path& folder, const std::filesystem::path& file);

/// Notes in `state` what a whole stack is told by: its figures, and the inputs that it was made of; `began_ns`: when
/// its making began. Writes its small picture; where that cannot be, gives back why, which takes nothing from the
/// result. Throws FileError, InputError where figures or inputs cannot be read.
[[nodiscard]] std::string take_stack(const std::filesystem::path& folder, std::int64_t began_ns,
                                     const std::filesystem::path& picture, JobState& state);

/// Whether the folder holds this very job's stack, whole, and its report.
[[nodiscard]] bool holds_job(const std::filesystem::path& folder, const PlannedJob& job,
                             const Progress* progress = nullptr);

/// Whether an interrupted loop of this very job waits in the folder.
[[nodiscard]] bool waits_to_go_on(const std::filesystem::path& folder, const PlannedJob& job);

}  // namespace voxtone::farm

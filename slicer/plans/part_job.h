// SPDX-License-Identifier: GPL-3.0-or-later
//
// A part of a tray by the job that it would be alone: {"job": "cow.json"} takes the options of a job file, {"job":
// "OUT"} those of a job that was done, and its appearance loop with them where its folder kept it. Words beside it in
// the part win over the job's.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slicer/options/slice_options.h"

namespace voxtone::io {
class JsonObject;
}

namespace voxtone::slicer {

inline constexpr std::string_view part_job_key = "job";

struct PartJob {
    std::string file;             ///< of its options
    std::string folder;           ///< of a job that was done; empty: a job file alone
    std::string printer, resins;  ///< as it says them, whole paths; empty: it does not
};

/// Sets in `options` all that the job file says but what is `of_the_tray` (keys of the table), which stays; resins to
/// be loaded are taken where the tray names none. `said`: gets the keys that are not at their defaults. Throws
/// InputError, FileError.
[[nodiscard]] PartJob take_part_job(const io::JsonObject& part, const std::filesystem::path& folder,
                                    std::span<const char* const> of_the_tray, SliceOptions& options,
                                    std::vector<std::string>& said);

}  // namespace voxtone::slicer

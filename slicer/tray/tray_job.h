// SPDX-License-Identifier: GPL-3.0-or-later
//
// Many parts in one print. Each part is a job of its own as far as its appearance loop, its prediction and its report
// go, in OUT/parts/NAME, where what it came to is kept: a tray that is stopped goes on with the part at which it was.
// Then its layers, as many copies as are wanted, are laid together into one stack in OUT.
//
// Parts that lie within 2 mm of each other are looked at as one body (joined_parts.h), the others alone.
#pragma once

#include <filesystem>
#include <string>

#include "base/job_result.h"
#include "base/progress.h"
#include "slicer/tray/tray_plan.h"

namespace voxtone::slicer {

inline constexpr std::string_view tray_file_name = "tray.json";

/// `plan.common` has OUT and what is the whole tray's. Throws InputError for parts that do not fit (no smaller tray is
/// made), and all that the jobs of the parts throw; OUT holds then what it held before.
[[nodiscard]] JobResult run_tray_job(const TrayPlan& plan, Progress& progress);

}  // namespace voxtone::slicer

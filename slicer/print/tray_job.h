// SPDX-License-Identifier: GPL-3.0-or-later
//
// Many parts in one print. Each part is a job of its own as far as its appearance loop, its prediction and its report
// go, in OUT/parts/NAME, where what it came to is kept: a tray that is stopped goes on with the part at which it was.
// Then its layers, as many copies as are wanted, are laid together into one stack in OUT, and in OUT-2 and so on where
// there are several trays.
//
// Parts that lie within 2 mm of each other are looked at as one body (joined_parts.h), the others alone.
#pragma once

#include "base/job_result.h"
#include "base/progress.h"
#include "slicer/options/slice_options.h"
#include "slicer/plans/tray_plan.h"

namespace voxtone::slicer {

/// `asked.model` is the tray's plan, or `models` are its parts. A part that fails is left out and told of, unless
/// `asked.fail_fast`. Throws InputError for parts that do not fit, and with `fail_fast` all that the jobs of the parts
/// throw; OUT holds then what it held before.
[[nodiscard]] JobResult run_tray_job(const SliceOptions& asked, const TrayModels& models, Progress& progress);

}  // namespace voxtone::slicer

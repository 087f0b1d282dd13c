// SPDX-License-Identifier: GPL-3.0-or-later
//
// A print from its models to a finished stack in its output folder, or as far as its appearance loop.
#pragma once

#include "slicer/print/plate.h"

namespace voxtone::slicer {

/// report.json or tray.json, and with `strict` check_failed where it will not look as asked. Throws Error (with its
/// exit code): the output folder holds then what it held before, or the whole new stack without its report.
[[nodiscard]] JobResult run_whole(Plate& plate, Progress& progress);

}  // namespace voxtone::slicer

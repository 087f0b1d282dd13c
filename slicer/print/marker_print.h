// SPDX-License-Identifier: GPL-3.0-or-later
//
// The marker to print before anything else on a machine (`voxtone target marker`): a plate of 52 x 32 x 4.5 mm that
// looks like itself in one way only, so that a look tells whether the printer mirrors, turns or exchanges the axes of
// its bitmaps, which side was up, and whether each resin is where it was meant.
//
//   - a raised tower in the corner where x and y begin: turned prints have it elsewhere
//   - a large raised F, the word TOP, and arrows with X and Y: mirrored ones cannot be read
//   - the word BOTTOM let into the underside, to be read from below
//   - a raised square of every loaded resin, with the resin's role in it
#pragma once

#include <string>
#include <vector>

#include "base/job_result.h"
#include "base/progress.h"
#include "io/layers/layer_stack_writer.h"
#include "slicer/print/print_boxes.h"
#include "slicer/printer/printer.h"

namespace voxtone::slicer {

struct MarkerJob {
    std::string out;
    std::string printer = "stratasys-j750-hm";
    std::vector<std::string> roles;  ///< loaded resins, two or more; empty: the printer's default
    io::StackOutputs outputs;
    bool overwrite = false;
};

/// What lies where, of these roles and of the printer's colours for them. Throws InputError for fewer than two roles or
/// one that is named twice.
[[nodiscard]] BoxPrint marker_boxes(const std::vector<std::string>& roles, const PrinterProfile& printer);

/// Throws UsageError, and what print_boxes throws.
[[nodiscard]] JobResult run_marker_job(const MarkerJob& job, Progress& progress);

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone laminate print`: slabs of layers of resin as a printable laminate, side by side along x, each as thick as
// its layers; what `laminate search` found, without a model (slicer/print/print_boxes.h).
//
// Borders between layers are rounded to whole printed layers (scattering/design/whole_layers.h), from the top.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/job_result.h"
#include "base/progress.h"
#include "io/layers/layer_stack_writer.h"

namespace voxtone::scattering {

struct LaminatePrintJob {
    std::vector<std::string> laminates;  ///< laminate files, or layers as "W 0.3, K 0.1"
    std::string resins;                  ///< empty: what the files say, else vero-opaque
    std::string printer = "stratasys-j750-hm";
    double width_mm = 20, depth_mm = 20, gap_mm = 5;  ///< of a slab along x and y, between slabs
    std::string base;                                 ///< "K=1mm": a layer below each slab; empty: none
    io::StackOutputs outputs;
    std::string out;
    bool overwrite = false;
};

/// Throws Error (with its exit code): also for materials that are no resins.
[[nodiscard]] JobResult run_laminate_print(const LaminatePrintJob& job, Progress& progress);

}  // namespace voxtone::scattering

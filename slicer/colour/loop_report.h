// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a job says of its appearance loop: errors by iteration, a magnified piece of the surface before and after, a cut
// through the resins.
//
// The magnified piece of a slab is the square whose mean difference fell most; the cut goes through its middle (through
// the middle of a body), upright along x, one pixel per voxel and direction scaled to true proportions.
#pragma once

#include <optional>
#include <vector>

#include "io/layers/manifest.h"
#include "io/report/report.h"
#include "slicer/colour/job_loop.h"
#include "slicer/part/job_body.h"

namespace voxtone::slicer {

/// `volume`: the print; null: without the cut.
[[nodiscard]] io::ReportLoop loop_report(const JobLoop& loop, const JobBody& body, const optics::ResinVolume* volume,
                                         const std::vector<io::Rgb>& palette);

}  // namespace voxtone::slicer

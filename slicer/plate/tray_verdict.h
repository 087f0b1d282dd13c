// SPDX-License-Identifier: GPL-3.0-or-later
//
// How a tray will look: by its bodies, the worst first.
#pragma once

#include <vector>

#include "io/report/report.h"

namespace voxtone::slicer {

/// Level and words; bounds and distance are the job's. Components are no bodies: nothing is predicted of them.
[[nodiscard]] io::ReportVerdict tray_verdict(const std::vector<const io::ReportPart*>& bodies);

}  // namespace voxtone::slicer

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The parts of the report page that its viewer brings to life (data/report/viewer): panels, data, the list of the worst
// places. Panels are hidden until a script that can show them finds them.
#pragma once

#include <string>

#include "io/report/report.h"

namespace voxtone::io {

/// Panels, data and the script that shows them before the browser has read the rest of the page; empty where there is
/// nothing to show.
[[nodiscard]] std::string viewer_panels(const Report& report);
/// The voxels, for the end of the page: nobody looks at them first.
[[nodiscard]] std::string viewer_voxels(const Report& report);
/// A section that can be read without the viewer too; empty where no place is known.
[[nodiscard]] std::string worst_section(const Report& report);

}  // namespace voxtone::io

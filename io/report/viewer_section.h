// SPDX-License-Identifier: GPL-3.0-or-later
//
// The parts of the report page that its viewer brings to life (data/report/viewer): panels, data, the list of the worst
// places. Panels are hidden until a script that can show them finds them.
#pragma once

#include <string>

#include "voxtone/io/report/report.h"

namespace voxtone::io {

/// Panels and data; empty where there is nothing to show.
[[nodiscard]] std::string viewer_panels(const Report& report);
/// A section that can be read without the viewer too; empty where no place is known.
[[nodiscard]] std::string worst_section(const Report& report);
/// One classic script; empty where there is nothing to show.
[[nodiscard]] std::string viewer_script(const Report& report);

}  // namespace voxtone::io

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Style and scripts of the report page (data/report/), which were put into the program, and text on its way into a
// page.
#pragma once

#include <string>
#include <string_view>

namespace voxtone::io {

/// By its name without folder and extension.
[[nodiscard]] std::string_view report_asset(std::string_view name);

/// JSON as it may stand inside a script element: no '<' remains that could end it.
[[nodiscard]] std::string in_script(std::string_view json);

}  // namespace voxtone::io

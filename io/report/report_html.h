// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a job has to say for itself, as one page to look at.
//
// The page needs nothing from outside (its policy forbids it) and works offline; every text is escaped, so that file
// and material names can hold anything. Its style and script are data/report/.
#pragma once

#include <cstddef>
#include <string>

#include "io/report/report.h"

namespace voxtone::io {

[[nodiscard]] std::string report_html(const Report& report);

/// Pages are no larger than this where what the viewer carries can be made to fit.
inline constexpr std::size_t most_page_bytes = 8'000'000;
/// About what the page takes without its viewer.
[[nodiscard]] std::size_t still_page_bytes(const Report& report);

}  // namespace voxtone::io

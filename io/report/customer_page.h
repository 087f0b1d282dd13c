// SPDX-License-Identifier: GPL-3.0-or-later
//
// What of a report is for who ordered the print: its name, what it will look like beside what was asked for, its size,
// the verdict, and what may break or is lost. One small page without voxels, layers or the shop's own figures.
#pragma once

#include <string>

#include "io/report/report.h"

namespace voxtone::io {

/// `customer`: who ordered it; may be empty.
[[nodiscard]] std::string customer_html(const Report& report, const std::string& customer = {});

}  // namespace voxtone::io

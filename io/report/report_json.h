// SPDX-License-Identifier: GPL-3.0-or-later
//
// The report of a job for programs: OUT/report.json (data/schema/report.schema.json).
#pragma once

#include <string>

#include "io/report/report.h"

namespace voxtone::io {

/// One JSON object, {"format": "voxtone-report", "version": 1, ...}; pictures are left out.
[[nodiscard]] std::string report_json(const Report& report);

}  // namespace voxtone::io

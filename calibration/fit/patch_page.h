// SPDX-License-Identifier: GPL-3.0-or-later
//
// Patches to look at, measured beside predicted, on the page that prints have too (io/report/report_html.h): its viewer
// shows them where they lie, a probe names the patch under the pointer, the worst are a list, all are a table.
#pragma once

#include <string>

#include "calibration/fit/patch_map.h"
#include "calibration/patches/patch_check.h"
#include "io/report/report.h"

namespace voxtone::calibration {

/// A page that shows `check` of `table` where `map` has its patches. `noise`: standard error of a reflectance where the
/// table gives none; 0: not known.
[[nodiscard]] io::Report patch_report(const PatchTable& table, const PatchCheck& check, const optics::ResinSet& set,
                                      const PatchMap& map, double noise);

/// The page of a check.
[[nodiscard]] std::string check_report_html(const PatchTable& table, const PatchCheck& check,
                                            const optics::ResinSet& set, const PatchMap& map);

}  // namespace voxtone::calibration

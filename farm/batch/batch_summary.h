// SPDX-License-Identifier: GPL-3.0-or-later
//
// What has become of a batch, to look at: OUT/index.html, one page without anything from outside, and the same for
// spreadsheets, OUT/summary.csv.
#pragma once

#include <string>
#include <vector>

#include "farm/batch/batch_folder.h"

namespace voxtone::farm {

inline constexpr const char* batch_page_name = "index.html";

/// Publishes both, of all states that there are. Throws FileError, TryAgain.
void write_batch_summary(const BatchFolder& folder);

/// Its lines end as RFC 4180 has them; of a job that is not done all figures are empty.
[[nodiscard]] std::string batch_csv(const std::vector<JobState>& states);
/// Links are seen from the batch's folder, from where also the small pictures are read.
[[nodiscard]] std::string batch_html(const BatchFolder& folder, const std::vector<JobState>& states);

}  // namespace voxtone::farm

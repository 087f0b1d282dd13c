// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures to look at: target and prints side by side, their differences, and the busiest place enlarged.
#pragma once

#include <filesystem>
#include <vector>

#include "judge_slab.h"

namespace voxtone::loop_benchmark {

/// Columns: target, then each print (the first judgement's target counts). Rows: as they are; CIEDE2000 to the target
/// (white 0, yellow 2, orange 5, red 10, black 20), beside it which pixels of the target are in gamut (white); the part
/// of the target with most contrast, enlarged six times.
void write_strip(const std::filesystem::path& file, const std::vector<const Judgement*>& prints);

}  // namespace voxtone::loop_benchmark

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The benchmark's tables, in Markdown.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "scores.h"
#include "variants.h"

namespace voxtone::loop_benchmark {

/// One target, printed in two ways.
struct SlabRow {
    std::string name;
    std::array<Scores, 2> scores;
    std::array<Print, 2> print;
    double share_in_gamut = 0;
    bool gratings = false, held_out = false;
    std::array<std::array<double, 3>, 2> modulation{};
};

[[nodiscard]] std::string slab_tables(const std::vector<SlabRow>& rows, const std::vector<std::string>& variant_names);

}  // namespace voxtone::loop_benchmark

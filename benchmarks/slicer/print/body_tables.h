// SPDX-License-Identifier: GPL-3.0-or-later
//
// Errors over the surface of bodies, thin parts apart.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "judge_body.h"
#include "scores.h"
#include "variants.h"

namespace voxtone::loop_benchmark {

struct BodyFigures {
    Figures seen;         ///< after the eye filter that the loop goes by, not over the paper's level: a window has none
    Figures cells;        ///< cell by cell
    double sampling = 0;  ///< standard error of the mean as seen, over windows
};

struct BodyRow {
    std::string name;
    std::array<BodyFigures, 2> thick, thin;  ///< of judged cells whose target is in the gamut of a thick body
    std::array<Print, 2> print;
    std::size_t windows = 0;
    double thin_share = 0;
};

[[nodiscard]] std::array<BodyFigures, 2> body_figures(const BodyJudgement& j,
                                                      double viewing_distance_mm);  ///< thick, thin

/// Of each solid of a body whose windows lie in them: CIEDE2000 between the means of print and target in its windows,
/// both as the eye's narrowest Gaussian leaves them: as solids of pages are judged, and as the program looks at
/// regions.
[[nodiscard]] std::vector<double> solid_differences(const BodyJudgement& j, double viewing_distance_mm);

struct FigurineRow {
    std::string name;
    std::vector<BodyJudgement::Solid> solids;
    std::array<std::vector<double>, 2> difference;  ///< open loop, loop
};
[[nodiscard]] std::string figurine_table(const std::vector<FigurineRow>& rows);

[[nodiscard]] std::string body_table(const std::vector<BodyRow>& rows, const std::vector<std::string>& variant_names);

}  // namespace voxtone::loop_benchmark

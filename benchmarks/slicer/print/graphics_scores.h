// SPDX-License-Identifier: GPL-3.0-or-later
//
// A print of graphics as a person judges it who takes its own paper for white: region by region
// (halftone/loop/colour_regions.h), Monte Carlo of the finished stack over the level of its paper (paper.h).
#pragma once

#include <string>
#include <vector>

#include "judge_slab.h"
#include "printed_codes.h"

namespace voxtone::loop_benchmark {

struct SolidScore {
    Eigen::Vector3f target;
    double area_mm2 = 0, difference = 0, unevenness = 0;
};

struct GraphicScores {
    double paper_level = 1;
    std::vector<SolidScore> solids;  ///< in the order of the target's regions, the same for every print of it
    double worst_solid = 0, mean_solid = 0, unevenness = 0;  ///< CIEDE2000; mean over solids of the last
    double rim = 0;           ///< mean chroma of print minus target within 0.5 mm of a region's edge, CIELAB
    double paper = 0;         ///< mean CIEDE2000 of paper cells as seen, after adaptation; 0: there is none
    double paper_chroma = 0;  ///< of the paper's mean
    double contrast = 0;      ///< of strokes against the largest region, of the target's; 0: there are none
    double flip = 0;          ///< mean, 300 mm or as far as asked (flip.h), after adaptation
    ReadCodes codes;          ///< of the page of codes
    double seen = 0;          ///< mean CIEDE2000 of all cells as seen, after adaptation
};

[[nodiscard]] GraphicScores graphic_scores(const Judgement& j, double viewing_distance_mm);
/// The page of codes has them besides.
void score_codes(const Judgement& j, GraphicScores& s);

struct GraphicRow {
    std::string name;
    bool held_out = false;
    std::array<GraphicScores, 2> scores;  ///< open loop, loop
};

[[nodiscard]] std::string graphics_table(const std::vector<GraphicRow>& rows);

}  // namespace voxtone::loop_benchmark

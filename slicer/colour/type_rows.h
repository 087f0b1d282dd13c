// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which pieces of a print's target are letters.
//
// A piece is what hangs together on one flat region of a square millimetre or more (paper or a solid:
// halftone/loop/colour_regions.h) and differs from it, by 0.12 in Oklab's lightness at the most; what lies between two
// such regions is their blurred border. Pieces are measured in the plane that they lie in (a body's letters in that of
// their mean normal, upright by z), along 24 directions, by the cells that are at least half as far from the ground as
// the farthest. Small letters touch, for a cell between them has something of both: a piece is cut into what hangs
// together by cells that are 0.4 as far.
//
// Type stands in rows. For one direction two pieces are linked where they are of about one height (within 1.8), lie
// within two heights of each other along it, and stand on one line or reach to one: to an eighth of the height, or to a
// cell. Four and more that are linked are a row. Spots, specks and photographs have some by chance, so all pieces that
// are near each other and of about one height are letters where six tenths of them stand in rows, and none is
// elsewhere. Of 24 directions the one with most in rows counts, the upright first, so that type may run along any. Not
// type is
//   - what stands as the dots of a screen, less than six cells wide: the way to the nearest is one and the same, to a
//     quarter of a cell, for a quarter of them and for ten;
//   - what is the same again: ticks, crosses, bricks. Ink of linked ones, the difference over the sum, is in the middle
//     0.04 to 0.4 in a dozen words and numbers of four faces of DejaVu (0.02 of "illicit"); less than 0.03 is a
//     pattern;
//   - what is filled: s = A / (4 pi sqrt(det M)) of area A and second moments M is 1 of an ellipse, 0.95 of a bar, 0.3
//     to 0.64 of those words. Where the middle one of those that are six cells high and more is above 0.75, they are
//     spots;
//   - bars side by side, as in resolution charts: in each line along them ink lies the same way. With means m
//     and variances v along the lines (one a cell) of a direction, u = sum ink ((m_line - m)^2 + |v_line - v|) / (v sum
//     ink), the least of 48 directions, is in the middle 0 to 0.18 of bars of 0.06 to 0.4 mm (0.20 of fewer than four)
//     and 0.21 to 0.52 of words (0.30 where few of their letters are large enough). Where the middle one of those that
//     are six cells wide and more is below 0.19, of fewer than four below 0.25, they are bars. Bold words of stems
//     ("Exit 4 mm": 0.12 to 0.15) lie below, too; their ink differs by 0.18 to 0.24. From 0.15 on only what is below
//     0.115 are bars: their ink differs by 0.13 as a rule, and by 0.29 at the most, with 0 to 0.104 then.
// What it cannot see: type on textures, fewer than four letters, letters of more than 1 mm2 in one piece (solids);
// words of l and i alone; bars that are shorter than six cells.
#pragma once

#include <cstdint>
#include <vector>

#include "slicer/colour/job_prediction.h"

namespace voxtone::slicer {

struct Letter {
    std::vector<std::uint32_t> cells;
    double area_mm2 = 0;
    double line_mm = 0;  ///< the 80th percentile of the heights in its row: that of capitals
};

struct FoundType {
    std::vector<Letter> letters;
    std::vector<std::vector<std::uint32_t>> others;  ///< cells of pieces that are none
};

[[nodiscard]] FoundType find_type(const JobPrediction& prediction);

}  // namespace voxtone::slicer

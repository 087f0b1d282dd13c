// SPDX-License-Identifier: GPL-3.0-or-later
//
// The steps that an appearance loop has made, and what follows from their scores: whether another one is worth its
// price, how long a step of feedback is, when the loop ends.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "optics/colour/colour.h"

namespace voxtone::halftone {

/// What made an iterate; the characters are those of checkpoints.
enum class LoopMethod : char {
    open_loop = 'o',
    feedback = 'f',
    descent = 'd',
};

/// Errors of one iterate.
struct LoopStep {
    int iteration = 0;
    LoopMethod method = LoopMethod::open_loop;
    optics::DifferenceSummary seen;   ///< after the eye filter
    optics::DifferenceSummary cells;  ///< as they are
    double score = 0;                 ///< what the loop goes by (loop_measure.h)
    float paper = 1;                  ///< level of its paper (paper.h)
    double saturated_share = 0;       ///< of the cells, at their limits, in the step that made this iterate
    double seconds = 0;  ///< of distributing and predicting; 0: of predicting, the print is made before the white twin
};

/// Another step of feedback is worth its price while the mean error as seen falls by 3 %; what makes it fall by less at
/// once is no good. Not chosen anew since feedback corrects what is seen. Of 0.94, 0.97 and 0.99 on the fitting set
/// (its four pictures by `slice FILE --width 4mm --thickness 2mm --predict none`, spot and fox by `--size 8mm`;
/// benchmarks/sets.json) five come out the same; img_kodim23 has 3.10, 3.04 and 3.04 as seen.
inline constexpr double worthwhile = 0.97;

/// Of the steps by `method`, or of all. Infinite where there is none.
[[nodiscard]] double least_score(const std::vector<LoopStep>& steps, std::optional<LoopMethod> method = {});

/// Corrections become smaller where they overshot: on large bodies light spreads farther than a step can know.
[[nodiscard]] float feedback_gain(const std::vector<LoopStep>& steps);

/// True where the last steps, as many as the patience with the method that made the last one, gained too little, or
/// where feedback has arrived.
[[nodiscard]] bool stopped_gaining(const std::vector<LoopStep>& steps);

/// True where the first two steps of a descent, and no more have been made, are worse by more than 3 % than what they
/// began from: it threw the print off, and hardly comes back. With rates that were as long near the target as far from
/// it (docs/decisions/003), `j750-vivid`, 20 mm (`slice FILE --width 20mm`), that was so of text, fine_print, gratings
/// and img_astronaut and of a sign, a flag and a card, of which one came to more after five further steps
/// (gratings: 3.44, then 4.03, 3.71, ... 3.27, 3.10), which take half of a loop's time; colour_checker, img_kodim23 and
/// img_hubble gained from the first step on. A print that is still bad, above 5 as seen, is given its time: of a page
/// of codes, at 5.3, it brought the blacks from 4.5 to 3.5 (`appearance_loop_benchmark graphics --paths 48`, mean of
/// solids).
[[nodiscard]] bool descent_lost_its_way(const std::vector<LoopStep>& steps);

/// About, of `allowed` steps: all while they gain, the fewer the longer they have not.
[[nodiscard]] std::size_t steps_left(const std::vector<LoopStep>& steps, std::size_t allowed);

}  // namespace voxtone::halftone

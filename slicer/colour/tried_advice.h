// SPDX-License-Identifier: GPL-3.0-or-later
//
// What to try where a print is not as asked: each with what it would come to, by a cheap prediction, or not at all.
//
// The verdict's mean m is taken for a sum: what no mixture reaches (reach_mean), what is lost in thin walls, what flat
// areas are off in their middles (flat), what light does between neighbours. Then
//
//   larger by k   reach + flat + (thin - thick) t + (neighbours + thick) k^-e,
//                 t = max(0, 2 depth - k wall) / (2 depth - wall), thick: what thin walls are off that are thick (0:
//                 not known). Light spreads over a fixed length, so that what is off is a band of fixed width: e = 1
//                 beside edges. Where details are no wider than the band, e is less: it is measured on the target
//                 itself, blurred by 0.5 and by 0.25 mm, e = log2 of the ratio of what the two change, at most 1. What
//                 goes farther than 0.5 mm grows no less; middles of flat areas come nearer only where light from afar
//                 is what they are off by, and the loop leaves more of what is harder. So both ends are said: with
//                 flat areas that come nearer, and by a quarter of e where they do not: squares of 0.6 mm, 8.4 without
//                 the loop, came to 7.3 at 2.1 times their size, e = 0.18 for 0.64. With the loop the bundled cow of 12
//                 mm, 3.4, came to 2.9 at 16.5 mm, 2.7 at 20 and 2.1 at 25, a barrel of 12 mm, 2.6, to 2.3 at 15 mm. Of
//                 walls light falls to a third in 0.25 mm at best (a spider of 15 mm with legs of 0.3 mm, 14.0, came to
//                 5.5 at twice that). What is too small to be seen becomes visible: a page's print is at most what
//                 this one would be from as much nearer, where light had spread as much farther (a menu of 8 mm on
//                 cream, 5.5, came to 8.5 at 16 mm). As large is advised as makes their middle good and
//                 of what is clearly off, flecked or blurred, which shrinks as 1 / k, too little to mind (0.20 of
//                 kodim23 of 12 mm came to 0.15, 0.11 and 0.08 at 16, 20 and 26 mm; 0.35 of an astronaut of 10 mm to
//                 0.29, 0.23 and 0.15 at 15, 20 and 30 mm); where type cannot
//                 be read, as makes it readable (type_size.h) and a tenth more, and where a code is not,
//                 its modules 0.4 mm, said by that. Not after a loop that was cut short: another size would be cut
//                 short elsewhere
//   thicker walls the cells of thin walls become as those are that have a core behind them. Where hardly any has one,
//   of walls
//                 below 0.25 mm at most 0.35 of it is left, said as a bound: of open sheets of one voxel that were
//                 given 2 mm 0.29 or less was left, with the loop and without (checks; soft, light, saturated and dark
//                 hills 0.04 to 0.25). Of pictures by --thickness; of sheets that enclose nothing, whose faces have
//                 their own backs in the same place (mesh/open_pieces.h), by --sheet-thickness, where half of the
//                 thin walls are those; from a quarter on, of their area or of what is lost in walls below 0.15 mm, as
//                 if the others stayed as they are (mages of 13 and 20 mm, 7.1 and 5.1: "5.2 or less" and "3.1 or less"
//                 were said, 3.8 and 1.9 came)
//   the loop      of what reach leaves, at most `left_by_loop` is left: a bound, and said as one ("or less"). Left were
//                 of the bundled cow of 12, 18 and 30 mm 0.61, 0.57 and 0.47, a mage of 12 mm 0.62, a fox of 12 and 18
//                 mm 0.50 and 0.47, a box of 6 mm 0.48, kodim23 0.42, a plate of 0.5 mm 0.17, of 0.3 mm 0.13, of 0.2 mm
//                 0.59, a banana of 16 mm 0.10; of a sheet of one voxel 0.87, so that of walls below 0.25 mm all is
//                 taken to be left. Where it was cut short its last gains go on as a geometric series, to no less than
//                 that bound
//   resins, core  the mean that the separation's own model gives for 400 colours of the surface (resin_choice.h)
//
// What brings less than a tenth of m, or of what is out of reach, is no advice. Tests follow each of them on small
// models (tests/cli/verdict_test.cpp).
#pragma once

#include <optional>
#include <vector>

#include "io/report/report.h"
#include "slicer/colour/job_loop.h"
#include "slicer/colour/job_prediction.h"
#include "slicer/colour/whole_verdict.h"
#include "slicer/part/opened_job.h"

namespace voxtone::slicer {

/// What the mean is made of.
struct MeanParts {
    double reach = 0, thin = 0, flat = 0, neighbours = 0;
    double thinnest = 0;     ///< of `thin`: in walls as thin as sheets that enclose nothing are printed
    double wall_mm = 0;      ///< of the thin walls, about
    double thick_walls = 0;  ///< what `thin` would be were they thick; `thin`: not known
    double thin_mm2 = 0;     ///< of the thin walls
    double reach_off = 0;    ///< of what is seen: clearly off, and out of reach; in [0, 1]
    [[nodiscard]] double sum() const { return reach + thin + flat + neighbours; }
};

struct AdviceSources {
    const OpenedJob& job;
    const JobBody& body;
    const JobPrediction& prediction;
    const std::vector<double>& weight;  ///< per cell
    const std::optional<JobLoop>& loop;
    MeanParts mean;
    const PageVerdict& page;
    const WholeVerdict& whole;
};

/// What holds for certain first, a larger size last. Of a print that is not good.
[[nodiscard]] std::vector<io::ReportAdvice> tried_advice(const AdviceSources& sources);

/// Where colours are out of the resins' reach, which is known without a prediction. Takes as long as separating a few
/// thousand colours.
[[nodiscard]] std::vector<io::ReportAdvice> advice_on_reach(const OpenedJob& job, const JobBody& body);

/// m where the print is k times as large. `exponent`: e.
[[nodiscard]] double mean_when_larger(const MeanParts& mean, double k, double exponent, double thick_mm,
                                      double fading_mm = 0);

/// Of means of iterates, the last the best: about what further ones would come to; `more` at most.
[[nodiscard]] double mean_of_longer_loop(const std::vector<double>& means, int more);

}  // namespace voxtone::slicer

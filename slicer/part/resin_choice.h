// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which resins a printer with few slots is loaded with, where the user did not say: those that show the model's colours
// best.
//
// Every set of resins that fits and holds the core's is asked for a sample of the colours of the coloured surface, 400
// points spread evenly over its area, with the separation's own model and inversion (halftone/separation), so without a
// lattice. The set with the smallest mean CIEDE2000 is loaded; of equals the printer's default, then the first. Clear
// resin (T) carries no colour and is not a candidate. Six sets of three out of five take about a second of one core.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "slicer/part/job_body.h"
#include "slicer/part/opened_job.h"

namespace voxtone::slicer {

struct ResinChoice {
    std::vector<std::string> roles;
    double mean_de2000 = 0;  ///< of the sample, between what was asked for and what these resins can show
    std::string why;         ///< a sentence
};

/// Nothing where the user named resins, where the printer's default leaves a slot free or leaves nothing out, and where
/// the surface has no colour to choose for.
[[nodiscard]] std::optional<ResinChoice> choose_resins(const OpenedJob& job, const JobBody& body, Progress& progress);

/// The job with these, and why (OpenedJob::why_these_resins); as it was where there is nothing to choose.
[[nodiscard]] OpenedJob with_best_resins(OpenedJob job, const JobBody& body, Progress& progress);

/// A resin that is not loaded, and what the sample's mean would be with it.
struct HelpfulResin {
    std::string role;
    double mean_de2000 = 0, now_de2000 = 0;
    bool has_slot = false;    ///< the printer carries one more
    std::string loaded_with;  ///< all roles then, as --load has them
};
/// The one that would help most; nothing where none brings the mean down by a quarter and by half a unit.
[[nodiscard]] std::optional<HelpfulResin> most_helpful_resin(const OpenedJob& job, const JobBody& body);

/// What the sample's mean would be over a core of white; nothing where the core is white, where white is not loaded,
/// and where that brings it down by no more than a quarter and half a unit.
struct CoreLoss {
    double mean_de2000 = 0, now_de2000 = 0;
};
[[nodiscard]] std::optional<CoreLoss> loss_with_white_core(const OpenedJob& job, const JobBody& body);

}  // namespace voxtone::slicer

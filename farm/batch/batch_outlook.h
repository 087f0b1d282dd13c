// SPDX-License-Identifier: GPL-3.0-or-later
//
// When the rest of a batch will be done, from the states of its jobs alone.
//
// A job's work is counted in seconds of a core: of one that is done, its time by its threads; of one that is left, its
// estimate times what the estimates of this run's jobs were off by, or, without one, what those that are done took. How
// far single jobs are off, and how well the common factor is known, is taken from the same jobs, as logarithms; before
// any is done estimates are taken to be within a factor of 1.5 (docs/estimate.md), and jobs without one to differ by a
// factor of 3. The rest of the batch is then gone through some hundred times, with jobs that take so long as may be, on
// as many lanes as the run has had: the range holds all of these but for a fortieth at each end.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "farm/batch/job_state.h"

namespace voxtone::farm {

struct BatchOutlook {
    std::size_t left = 0;            ///< jobs, those that run included
    std::size_t measured = 0;        ///< jobs of this run that are done
    double seconds = 0;              ///< from now on, until all are done
    double least_s = 0, most_s = 0;  ///< 19 of 20 batches end between
};

/// `now_s`: since 1970. Nothing where nothing is left, nothing has been worked on for a minute, or nothing can be said
/// yet: no job of this run is done, and there is no estimate.
[[nodiscard]] std::optional<BatchOutlook> batch_outlook(std::span<const JobState> states, double now_s);

/// "the rest, 12 jobs, in 50 min to 1 h 30 min", without a line break.
[[nodiscard]] std::string outlook_text(const BatchOutlook& outlook);

}  // namespace voxtone::farm

// SPDX-License-Identifier: GPL-3.0-or-later
//
// An estimate for programs and for people.
#pragma once

#include <string>

#include "slicer/print/job_estimate.h"

namespace voxtone::slicer {

/// One object in one line (data/schema/estimate.schema.json).
[[nodiscard]] std::string estimate_json(const JobEstimate& estimate);

/// A table of resins, one of phases, and what they add up to.
[[nodiscard]] std::string estimate_text(const JobEstimate& estimate);

/// The same in one line without a break, for a job that is about to start.
[[nodiscard]] std::string estimate_summary(const JobEstimate& estimate);

/// How long the appearance loop takes of that and how to limit it; empty where that is soon over.
[[nodiscard]] std::string loop_advice(const JobEstimate& estimate);

}  // namespace voxtone::slicer

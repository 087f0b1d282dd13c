// SPDX-License-Identifier: GPL-3.0-or-later
//
// From what the user wrote to what it means, by the option table.
#pragma once

#include "slicer/options/resolved_job.h"

namespace voxtone::slicer {

/// Throws UsageError that names the key, the value and the rule: for a text that is no value of its option, and for
/// values that do not go together.
[[nodiscard]] ResolvedJob resolve(const SliceOptions& options);

}  // namespace voxtone::slicer

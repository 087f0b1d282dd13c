// SPDX-License-Identifier: GPL-3.0-or-later
//
// Options that do nothing beside others: a width of a mesh, the layers of a colour print, the loop's intent without a
// loop. A user who names one expects it to do something, so it is refused and not ignored. What makes an option idle
// says its entry in the table (OptionSpec::only_for, idle).
#pragma once

#include "slicer/options/slice_options.h"

namespace voxtone::slicer {

/// Looks at the options that the user named (SliceOptions::named), at no defaults. Throws UsageError that names the
/// option and what makes it idle.
void check_scope(const SliceOptions& options);

/// Whether other options do nothing beside some value of this one. Who names one on the command line changes the job
/// of a file: what becomes idle in that file is no mistake.
[[nodiscard]] bool decides_scope(std::string_view key);

}  // namespace voxtone::slicer

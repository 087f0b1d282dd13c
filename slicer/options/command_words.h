// SPDX-License-Identifier: GPL-3.0-or-later
//
// From options back to the command line that says them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "slicer/options/slice_options.h"

namespace voxtone::slicer {

/// The words behind `voxtone`: "slice", the model, and every option that is not at its default.
[[nodiscard]] std::vector<std::string> command_words(const SliceOptions& options);

/// In one line that a POSIX shell takes apart into these words again.
[[nodiscard]] std::string shell_line(std::span<const std::string> arguments);

/// Sets to their defaults those options that this job would ignore, and names all others that are not at theirs. `kept`
/// stay as they are: the user said them of this very job, so that it is refused if it would ignore them.
void drop_idle(SliceOptions& options, std::span<const std::string> kept);

}  // namespace voxtone::slicer

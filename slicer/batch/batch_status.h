// SPDX-License-Identifier: GPL-3.0-or-later
//
// The verb `status`: how far a batch is, from its files alone. Anybody may ask at any time, also while it runs.
#pragma once

#include <filesystem>

#include "base/job_result.h"

namespace voxtone::slicer {

/// Throws InputError for a folder that is no batch's, FileError.
[[nodiscard]] JobResult batch_status(const std::filesystem::path& out);

}  // namespace voxtone::slicer

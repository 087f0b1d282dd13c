// SPDX-License-Identifier: GPL-3.0-or-later
//
// The verb `status`: how far a batch is, from its files. Anybody may ask at any time, also while it runs.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "base/job_result.h"

namespace voxtone::farm {

/// `remarks`: what else is known of jobs that are not done, by name. Throws InputError for a folder that is no batch's,
/// FileError.
[[nodiscard]] JobResult batch_status(const std::filesystem::path& out,
                                     const std::map<std::string, std::string>& remarks = {});

}  // namespace voxtone::farm

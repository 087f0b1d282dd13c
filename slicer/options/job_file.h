// SPDX-License-Identifier: GPL-3.0-or-later
//
// The job file: {"format": "voxtone-job", "version": 1, <key>: <value>, ...} with the keys of the option table.
#pragma once

#include <string>
#include <string_view>

#include "voxtone/slicer/options/slice_options.h"

namespace voxtone::slicer {

/// What `slice` calls the one that it leaves beside its layers.
inline constexpr std::string_view job_file_name = "job.json";

/// A job file as text, complete: every key with its value.
[[nodiscard]] std::string job_json(const SliceOptions& options);

/// Reads a job file into `options`: only the keys that it has. Unknown keys are errors that name the nearest known key.
/// Relative paths of the model and its texture, of the map of profiles and of measured materials are relative to the
/// job file. Throws FileError, InputError.
void read_job(const std::string& path, SliceOptions& options);

}  // namespace voxtone::slicer

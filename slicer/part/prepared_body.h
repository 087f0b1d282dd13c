// SPDX-License-Identifier: GPL-3.0-or-later
//
// A body as the first shard of a job prepared it, for the shards after it and for the merge: read, placed, repaired,
// with its visible surface and its textures filtered. OUT/shards/IDENTITY.prepared; 11 bytes a
// texel and some 300 a triangle; in native byte order, and gone with the merge. It belongs to one job and one version
// of the program: the caller has made sure that the inputs hold what they held.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "slicer/part/job_body.h"

namespace voxtone::slicer {

/// Does without where it cannot be written: each shard prepares the body then.
void keep_prepared(const std::filesystem::path& out, std::string_view job, const JobBody& body);

/// Nothing where there is none, of this job and version, whole.
[[nodiscard]] std::optional<JobBody> read_prepared(const std::filesystem::path& out, std::string_view job);

}  // namespace voxtone::slicer

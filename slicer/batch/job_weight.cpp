// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/batch/job_weight.h"

#include <filesystem>
#include <system_error>

namespace voxtone::slicer {

JobWeight weigh(const SliceOptions& options) {
    // The 6 MB of spot.obj and its texture at 60 mm take 0.9 GB with their loop; a million triangles some 1.5 GB.
    constexpr std::uint64_t least_bytes = std::uint64_t{1} << 30, bytes_of_each = 24;
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(options.model, error);
    return {least_bytes + (error ? 0 : size * bytes_of_each), options.threads};
}

}  // namespace voxtone::slicer

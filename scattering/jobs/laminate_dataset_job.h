// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone laminate dataset`: a data set of heterogeneous scattering, traced through a slab of a known pattern
// (optics/media/slab_patterns.h, optics/monte_carlo/sampled_bssrdf.h), for `laminate factor` and where nothing is
// measured.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/job_result.h"
#include "base/progress.h"
#include "optics/media/slab_patterns.h"

namespace voxtone::scattering {

/// How a user names them.
inline constexpr std::array<std::pair<std::string_view, optics::SlabPattern>, 3> slab_pattern_names{
    {{"marble", optics::SlabPattern::marble},
     {"chess", optics::SlabPattern::chess},
     {"stone", optics::SlabPattern::stone}}};

struct LaminateDatasetJob {
    optics::SlabOptions slab;                  ///< its margin follows from the radius
    std::uint32_t radius = 10;                 ///< of the window around a point, in points, [1, 64]
    std::uint32_t paths = 1000;                ///< per point and channel, [1, 2^24]
    std::optional<std::uint64_t> path_seed;    ///< of the paths alone; none: that of the slab
    std::string resins = "vero-opaque-clear";  ///< set with the roles W, K and T, or its file
    bool matched = false;                      ///< no refractive surface on either side
    std::string out;                           ///< file (io/profiles/bssrdf_file.h)
    bool overwrite = false;                    ///< it is replaced where it is there

    /// Throws InputError that names the value and the rule it breaks.
    void validate() const;
};

/// Throws Error (with its exit code): also for a file that would be larger than one may be.
[[nodiscard]] JobResult run_laminate_dataset(const LaminateDatasetJob& job, Progress& progress);

}  // namespace voxtone::scattering

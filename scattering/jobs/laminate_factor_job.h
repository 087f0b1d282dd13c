// SPDX-License-Identifier: GPL-3.0-or-later
//
// `voxtone laminate factor`: a data set of heterogeneous scattering, from and to files: factored, clustered, written as
// the profile map that a layered print takes (scattering/jobs/profile_map_job.h), with how far it is wrong.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "base/job_result.h"
#include "base/progress.h"
#include "scattering/jobs/profile_map_job.h"

namespace voxtone::scattering {

struct LaminateFactorJob {
    ProfileMapOptions map;
    std::string dataset;     ///< file (io/profiles/bssrdf_file.h)
    std::string out;         ///< NAME.json (io/profiles/profile_map.h)
    bool luminance = false;  ///< of the data, and of those to check with: one channel (luminance_channel.h)
    std::string tint;        ///< picture of a coloured skin over the data (tinted_responses.h); empty: none
    std::string check;       ///< other data of the same surface to compare with; empty: none
    std::string picture;     ///< PNG of data, factored and clustered side by side; empty: none
    bool overwrite = false;  ///< files that are there are replaced
    std::optional<std::array<std::uint32_t, 2>> point;  ///< column and row of the response that is drawn

    /// Throws UsageError or InputError that names the value and the rule it breaks.
    void validate() const;
};

/// Throws Error (with its exit code). Warns of factorisations that stopped early and of windows that are too small.
[[nodiscard]] JobResult run_laminate_factor(const LaminateFactorJob& job, Progress& progress);

}  // namespace voxtone::scattering

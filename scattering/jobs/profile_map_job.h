// SPDX-License-Identifier: GPL-3.0-or-later
//
// From a data set of heterogeneous scattering to the profiles that are wanted where: factored, clustered, as a profile
// map (Hasan et al. 2010, Sec. 7.1).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "io/profiles/bssrdf_file.h"
#include "io/profiles/profile_map.h"
#include "scattering/local_profiles/local_profiles.h"
#include "scattering/local_profiles/profile_clusters.h"
#include "scattering/local_profiles/profile_reconstruction.h"

namespace voxtone::scattering {

struct ProfileMapOptions {
    LocalProfileOptions factor;
    ClusterOptions clusters;
    /// All profiles are scaled by one number so that the brightest channel of the brightest cluster reflects this much;
    /// in (0, 1]. The paper takes 0.6, what 5 mm of its resins on black can show at most.
    std::optional<double> max_albedo;
    void validate() const;  ///< throws InputError that names the value and the rule it breaks
};

/// Of one channel.
struct ChannelOutcome {
    FactorSummary factor;
    ReconstructionError factored, clustered;  ///< before anything is scaled
    /// The same against data that the profiles were not found from; all 0 where there is none.
    ReconstructionError factored_checked, clustered_checked;
    double beyond_window = 0;  ///< share of light that the data set saw leave beyond its window
};

struct ProfileMapResult {
    io::ProfileMap map;
    LocalProfiles factored, clustered;  ///< not scaled
    ProfileClusters clusters;
    std::vector<ChannelOutcome> channels;
    double brightest = 0;  ///< albedo of the brightest channel of the brightest cluster, before it is scaled
    double scale = 1;
    double factor_seconds = 0, cluster_seconds = 0;
};

/// `check`: other data of the same surface, traced or measured once more; may be nullptr. InputError where its grid,
/// window or channels differ.
[[nodiscard]] ProfileMapResult make_profile_map(const io::BssrdfFile& data, const ProfileMapOptions& options,
                                                Progress& progress, const io::BssrdfFile* check = nullptr);

}  // namespace voxtone::scattering

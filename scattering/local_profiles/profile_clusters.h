// SPDX-License-Identifier: GPL-3.0-or-later
//
// Local profiles (local_profiles.h) put into few groups that are alike: k-means (S. Lloyd, "Least squares quantization
// in PCM", IEEE Trans. Inf. Theory 28, 1982) from the start of D. Arthur and S. Vassilvitskii ("k-means++", SODA 2007).
//
// Profiles are compared by the roots of their light by knot, over all channels:
//
//   d^2 = sum over channels and knots (sqrt(L_a) - sqrt(L_b))^2
//
// with L the light of the rings around the knot (light_by_knot): twice the squared Hellinger distance. So light counts
// and not the value per mm^2, which only the entry has much of; tails that light goes far in count more than their
// share, as the eye sees them; and the noise of counts is the same everywhere. A group's profile is the square of the
// mean of its members' roots: what pairs of points show are products of roots, so light is kept where it is seen (a
// mean of P would be too bright, by the noise of P too).
//
// Lloyd's algorithm is a page of code; a library's would draw from a generator with a state and add up in an order of
// its own, where the same groups are wanted to the bit for any number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "scattering/local_profiles/local_profiles.h"

namespace voxtone::scattering {

struct ClusterOptions {
    std::uint32_t clusters = 100;  ///< at most; [1, 65535]
    int max_rounds = 100;
    double tolerance = 1e-4;  ///< stop when a round makes the mean square of d smaller by no more than this share; >= 0
    std::uint64_t seed = 1;
    void validate() const;  ///< throws InputError that names the value and the rule it breaks
};

struct ProfileCluster {
    std::vector<std::vector<double>> P;  ///< [channel][knot]
    std::uint32_t points = 0;            ///< above 0
    double distance = 0;                 ///< root mean square of d of its members from their mean
};

struct ProfileClusters {
    std::vector<std::uint16_t> cluster;  ///< by point
    std::vector<ProfileCluster> clusters;
    double distance = 0;  ///< root mean square over all points
    int rounds = 0;
    bool converged = false;  ///< the tolerance was met
};

/// As many clusters as asked for, or as there are different profiles. The same bits for any number of threads.
[[nodiscard]] ProfileClusters cluster_profiles(const LocalProfiles& profiles, const ClusterOptions& options,
                                               const Progress* progress = nullptr);

/// Every point's profile is its cluster's.
[[nodiscard]] LocalProfiles clustered(const LocalProfiles& profiles, const ProfileClusters& clusters);

}  // namespace voxtone::scattering

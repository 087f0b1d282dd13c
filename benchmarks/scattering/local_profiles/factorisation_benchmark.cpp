// SPDX-License-Identifier: GPL-3.0-or-later
//
// Seconds to factor a data set of 256 x 256 points into local profiles and to cluster them; three channels, window of
// radius
// 10. Run: build/release/benchmarks/factorisation_benchmark [POINTS [COUNTS [THREADS]]]: points a side (256), counts
// that a point's brightest pair has (400), threads (0: one per core).
//
// The data: profiles exp(-r / width) albedo whose width and albedo wander over the surface by a factor of 3, as
// products of roots (Eq. 7), with counts drawn from Poisson's distribution. What is known of the profiles is held
// against what comes out.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "base/parallel.h"
#include "scattering/local_profiles/local_profiles.h"
#include "scattering/local_profiles/profile_clusters.h"
#include "scattering/local_profiles/profile_reconstruction.h"
#include "tests/scattering/local_profiles/response_samples.h"

using namespace voxtone;
using namespace voxtone::scattering;

namespace {

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

int main(int argc, char** argv) {
    const auto side = static_cast<std::uint32_t>(argc > 1 ? std::atoi(argv[1]) : 256);
    const double counts = argc > 2 ? std::atof(argv[2]) : 400;
    const ThreadLimit limit(static_cast<std::size_t>(argc > 3 ? std::atoi(argv[3]) : 0));
    const LocalProfiles truth = testing::wandering_profiles({side, side}, 10, 3);
    const optics::SampledBssrdf data = testing::separable_responses(truth, counts, 1);

    double begin = seconds();
    std::vector<FactorSummary> summary;
    const LocalProfiles profiles = factor_responses(data, {}, summary);
    const double factored = seconds() - begin;
    std::printf("%u x %u points, radius 10, %zu channels, %zu threads: factored in %.2f s\n", side, side,
                summary.size(), thread_count(), factored);
    for (std::size_t c = 0; c < summary.size(); ++c) {
        const ReconstructionError error = reconstruction_error(data, c, profiles);
        std::printf(
            "  channel %zu: %d Newton steps, %d iterations, residual %.1e; light in the wrong place %.4f (noise alone: "
            "%.4f), "
            "light %.5f; P known to %.4f of its light\n",
            c, summary[c].steps, summary[c].iterations, summary[c].residual, error.light_error, error.noise_error,
            error.light, testing::profile_error(truth, profiles, c));
    }
    begin = seconds();
    const ProfileClusters clusters = cluster_profiles(profiles, {});
    std::printf("clustered in %.2f s: %zu clusters, %d rounds, distance %.4f\n", seconds() - begin,
                clusters.clusters.size(), clusters.rounds, clusters.distance);
    return 0;
}

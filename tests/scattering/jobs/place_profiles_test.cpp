// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/jobs/place_profiles.h"

#include <numeric>

#include <catch2/catch.hpp>

#include "scattering/jobs/profile_map_job.h"
#include "tests/scattering/local_profiles/response_samples.h"

using namespace voxtone;
using namespace voxtone::scattering;

TEST_CASE("A map's profiles are its clusters' again, and places keep the light of their responses") {
    const LocalProfiles truth = scattering::testing::wandering_profiles({30, 26}, 5, 2);
    io::BssrdfFile data{"a test", {{500, 600}}, scattering::testing::separable_responses(truth, 0, 1)};
    ProfileMapOptions options;
    options.clusters.clusters = 12;
    Progress quiet;
    const ProfileMapResult made = make_profile_map(data, options, quiet);
    const LocalProfiles again = profiles_of_map(made.map);
    REQUIRE(again.radius == 5);
    CHECK(again.pitch_mm == Approx(0.5));
    CHECK(scattering::testing::profile_error(made.clustered, again, 0) < 0.02);
    CHECK(scattering::testing::profile_error(made.clustered, again, 1) < 0.02);

    const auto points = points_of_clusters(made.map, 5);
    const std::size_t all = std::accumulate(points.begin(), points.end(), std::size_t{0},
                                            [](std::size_t sum, const auto& of) { return sum + of.size(); });
    CHECK(all == 20 * 16);
    const optics::HankelGrid grid(10, 64);
    for (std::size_t k = 0; k < points.size(); ++k) {
        if (points[k].empty()) continue;
        const auto seen = place_profiles(data.responses, points[k]), model = place_profiles(made.factored, points[k]);
        for (std::size_t c = 0; c < 2; ++c) {
            double light = 0;
            for (const std::size_t i : points[k])
                for (const double R : response_at(data.responses, c, i))
                    light += R * data.responses.cell_mm2() / static_cast<double>(points[k].size());
            CHECK(seen[c].total() - seen[c].beyond == Approx(light));
            CHECK(seen[c].coefficients(grid, 0.5)[0] == Approx(seen[c].total()));
            CHECK(seen[c].per_mm2[0] > seen[c].per_mm2[2]);
            for (std::size_t knot = 0; knot <= 5; ++knot)
                CHECK(model[c].light[knot] == Approx(seen[c].light[knot]).epsilon(0.02).margin(1e-4));
        }
    }
}

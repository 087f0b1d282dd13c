// SPDX-License-Identifier: GPL-3.0-or-later
//
// Steps through spheres against walks from scattering to scattering.
#include "optics/monte_carlo/first_passage.h"

#include <cmath>

#include <catch2/catch.hpp>

#include "optics/monte_carlo/voxel_walk.h"

using namespace voxtone::optics;

namespace {

/// Of what leaves a sphere: what is lost, and the cosine to its normal weighed by the weight; their standard errors.
struct Left {
    double lost = 0, cosine = 0, lost_error = 0, cosine_error = 0;
};

Left walked(const Medium& medium, double g, double radius, std::uint32_t paths) {
    double weights = 0, squares = 0, cosines = 0, cosine_squares = 0;
    for (std::uint32_t path = 0; path < paths; ++path) {
        PathRandom random(99, {{0, 0, 0}, 0, path});
        std::array<double, 3> at{}, d{0, 0, 1};
        turn_henyey_greenstein(d, 0, random);
        double weight = 1;
        for (;;) {
            double way = 0, square = 0;
            for (std::size_t a = 0; a < 3; ++a) way += at[a] * d[a], square += at[a] * at[a];
            const double to_skin = -way + std::sqrt(way * way - square + radius * radius);
            const double free = -std::log1p(-random.uniform()) / medium.sigma_t();
            if (free >= to_skin) {
                const double mu = (way + to_skin) / radius;
                weights += weight, squares += weight * weight;
                cosines += weight * mu, cosine_squares += weight * mu * mu;
                break;
            }
            for (std::size_t a = 0; a < 3; ++a) at[a] += free * d[a];
            weight *= medium.albedo();
            turn_henyey_greenstein(d, g, random);
        }
    }
    const double n = paths, mean = weights / n, mu = cosines / weights;
    return {1 - mean, mu, std::sqrt((squares / n - mean * mean) / n),
            std::sqrt((cosine_squares / weights - mu * mu) / n)};
}

double mean_cosine(const FirstPassage& passage, std::size_t sphere) {
    double sum = 0;
    const auto& mu = passage.cosines(sphere);
    for (std::size_t k = 0; k < FirstPassage::intervals; ++k)
        sum += static_cast<double>(mu[k] + mu[k + 1]) / (2.0 * FirstPassage::intervals);
    return sum;
}

}  // namespace

TEST_CASE("what leaves a sphere is as much, and as steep, as if every scattering had been walked to") {
    const std::array<double, 4> radii{0.7, 1, 1.4, 2};
    for (const double g : {0.4, 0.0, -0.3})
        for (const double albedo : {0.9997, 0.97}) {
            const Medium medium{9 * (1 - albedo), 9 * albedo};
            const FirstPassage passage(medium, g, radii);
            REQUIRE(passage.first() == 0);
            for (const std::size_t i : {0u, 3u}) {
                const Left left = walked(medium, g, radii[i], 20000);
                const double lost = 1 - passage.weight(i), mu = mean_cosine(passage, i);
                INFO("g " << g << ", albedo " << albedo << ", radius " << radii[i] << ": lost " << lost << " for "
                          << left.lost << " +- " << left.lost_error << ", cosine " << mu << " for " << left.cosine
                          << " +- " << left.cosine_error);
                // 24 values; the table's own cosines come from 8192 paths.
                CHECK(std::abs(lost - left.lost) < 4 * left.lost_error);
                CHECK(std::abs(1.04 * lost - left.lost) > 4 * left.lost_error);
                CHECK(std::abs(mu - left.cosine) < 4 * std::sqrt(1 + 20000 / 8192.0) * left.cosine_error);
                CHECK(std::abs(1.04 * mu - left.cosine) > 4 * left.cosine_error);
            }
        }
}

TEST_CASE("resins that scatter forward lose no more in a sphere than walks say") {
    const std::array<double, 4> radii{0.7, 1, 1.4, 2};
    for (const double g : {0.8, 0.9}) {
        const Medium medium{0.09, 8.91};
        const FirstPassage passage(medium, g, radii);
        const Left left = walked(medium, g, radii[3], 20000);
        const double lost = 1 - passage.weight(3);
        INFO("g " << g << ": lost " << lost << " for " << left.lost << " +- " << left.lost_error);
        CHECK(std::abs(lost - left.lost) < 4 * left.lost_error);
        CHECK(std::abs(1.1 * lost - left.lost) > 4 * left.lost_error);
    }
}

TEST_CASE("where nothing absorbs a step through a sphere keeps all light, and small spheres have none") {
    const FirstPassage passage({0, 10}, 0.4, std::array{0.3, 0.8, 1.2});
    CHECK(passage.first() == 1);
    CHECK(passage.weight(1) == Approx(1).epsilon(1e-12));
    CHECK(passage.weight(2) == Approx(1).epsilon(1e-12));
}

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Steps through spheres against walks from scattering to scattering, and who takes them.
#include "optics/monte_carlo/first_passage.h"

#include <cmath>
#include <span>
#include <vector>

#include <catch2/catch.hpp>

#include "optics/monte_carlo/path_packets.h"
#include "optics/monte_carlo/voxel_walk.h"

using namespace voxtone::optics;

namespace {

/// Of what leaves a sphere: what is lost, and the cosine to its normal weighed by the weight; their standard errors.
struct Left {
    double lost = 0, cosine = 0, lost_error = 0, cosine_error = 0;
};

/// By radius, ascending, and by albedo: a walk to the largest sphere leaves all others on its way, and where it goes
/// does not depend on what is absorbed.
std::vector<std::vector<Left>> walked(double sigma_t, std::span<const double> albedos, double g,
                                      std::span<const double> radii, std::uint32_t paths) {
    struct Sums {
        double weights = 0, squares = 0, cosines = 0, cosine_squares = 0;
    };
    std::vector<std::vector<Sums>> sums(radii.size(), std::vector<Sums>(albedos.size()));
    for (std::uint32_t path = 0; path < paths; ++path) {
        PathRandom random(99, {{0, 0, 0}, 0, path});
        std::array<double, 3> at{}, d{0, 0, 1};
        turn_henyey_greenstein(d, 0, random);
        std::size_t inside = 0;
        for (int scatterings = 0;; ++scatterings) {
            double way = 0, square = 0;
            for (std::size_t a = 0; a < 3; ++a) way += at[a] * d[a], square += at[a] * at[a];
            const double free = -std::log1p(-random.uniform()) / sigma_t;
            for (; inside < radii.size(); ++inside) {
                const double to_skin = -way + std::sqrt(way * way - square + radii[inside] * radii[inside]);
                if (free < to_skin) break;
                const double mu = (way + to_skin) / radii[inside];
                for (std::size_t k = 0; k < albedos.size(); ++k) {
                    Sums& s = sums[inside][k];
                    const double weight = std::pow(albedos[k], scatterings);
                    s.weights += weight, s.squares += weight * weight;
                    s.cosines += weight * mu, s.cosine_squares += weight * mu * mu;
                }
            }
            if (inside == radii.size()) break;
            for (std::size_t a = 0; a < 3; ++a) at[a] += free * d[a];
            turn_henyey_greenstein(d, g, random);
        }
    }
    std::vector<std::vector<Left>> left(radii.size());
    for (std::size_t i = 0; i < radii.size(); ++i)
        for (const Sums& s : sums[i]) {
            const double n = paths, mean = s.weights / n, mu = s.cosines / s.weights;
            left[i].push_back({1 - mean, mu, std::sqrt((s.squares / n - mean * mean) / n),
                               std::sqrt((s.cosine_squares / s.weights - mu * mu) / n)});
        }
    return left;
}

double mean_cosine(const FirstPassage& passage, std::size_t sphere) {
    double sum = 0;
    const auto& mu = passage.cosines(sphere);
    for (std::size_t k = 0; k < FirstPassage::intervals; ++k)
        sum += static_cast<double>(mu[k] + mu[k + 1]) / (2.0 * FirstPassage::intervals);
    return sum;
}

/// Legendre's P_1 and P_2 of the angle by which light was scattered, their sums and squares.
struct Turned {
    double count = 0;
    std::array<double, 2> sum{}, squares{};
    void add(double c) {
        const std::array<double, 2> P{c, 1.5 * c * c - 0.5};
        ++count;
        for (std::size_t l = 0; l < 2; ++l) sum[l] += P[l], squares[l] += P[l] * P[l];
    }
    /// How many standard errors the mean of P_l lies above this.
    [[nodiscard]] double off(std::size_t l, double wanted) const {
        const double mean = sum[l - 1] / count;
        return (mean - wanted) / std::sqrt((squares[l - 1] / count - mean * mean) / count);
    }
};

/// One scattering each, in the middle of a body that is so thin that few paths meet another. Even ones cross a sphere
/// of no size whose skin all light leaves along the normal, which is what an even scattering is, and keep half their
/// weight: that tells them.
class OneScattering : public PathSource {
public:
    OneScattering(double g, std::uint32_t paths) : paths_(paths) {
        resins_.resins = {{"Resin", "W", {1e-4, 1e-4, 1e-4}, {1, 1, 1}}};
        resins_.g = g;
        resins_.eta = 1;
        const Scene scene{.volume = &volume_, .resins = &resins_};
        const PathVolume volume(scene, &sides_);
        PacketScene packets = packet_scene(scene, volume, 0, 0.1);
        const std::vector<std::uint8_t> fitting(
            static_cast<std::size_t>((packets.size[0] + 7) / 8 * ((packets.size[1] + 7) / 8) *
                                     ((packets.size[2] + 7) / 8)) +
                3,
            1);
        const std::vector<float> weights(1, 0.5f), cosines(FirstPassage::intervals + 1, 1.0f);
        packets.spheres.material = 1;
        packets.spheres.fitting = fitting.data();
        for (std::size_t a = 0; a < 3; ++a) packets.spheres.cells[a] = (packets.size[a] + 7) / 8;
        packets.spheres.radius_mm.fill(0);
        packets.spheres.weights = weights.data();
        packets.spheres.cosines = cosines.data();
        packets.tells_exits = true;
        for (std::size_t a = 0; a < 3; ++a) start_.at[a] = static_cast<float>(packets.size[a]) / 2 + 0.25f;
        for (std::size_t a = 0; a < 3; ++a) start_.voxel[a] = packets.size[a] / 2;
        start_.direction = {0.6f, 1e-6f, 0.8f};
        start_.depth = 1e-5f;
        trace_packets(packets, *this);
    }
    Turned all, even;

private:
    bool next(PathStart& start) override {
        if (begun_ == paths_) return false;
        start = start_;
        start.random = path_state(5, {{0, 0, 0}, 0, begun_++});
        return true;
    }
    void finished(std::uint32_t, float, const std::array<float, 3>&) override { FAIL("no path ends within"); }
    void left(std::uint32_t, float weight, const PathExit& exit) override {
        const double cosine = 0.6 * exit.way[0] + 0.8 * exit.way[2];
        all.add(cosine);
        if (weight < 1) even.add(cosine);
    }
    std::array<float, 3> entering_up(std::array<std::uint32_t, 4>&) override { return {0, 0, 1}; }

    std::uint32_t paths_, begun_ = 0;
    ResinSet resins_;
    ResinVolume volume_ = make_resin_volume({40, 40, 40}, {0.05, 0.05, 0.05}, [](int, int, int) { return 1; });
    FlatSides sides_{
        {{{1, 0, 0}, 2}, {{-1, 0, 0}, 0}, {{0, 1, 0}, 2}, {{0, -1, 0}, 0}, {{0, 0, 1}, 2}, {{0, 0, -1}, 0}}};
    PathStart start_;
};

}  // namespace

TEST_CASE("as many scatterings are even as Henyey and Greenstein's function has in common with an even one") {
    constexpr double paths = 200000;
    for (const double g : {0.4, 0.8, -0.5}) {
        const OneScattering scattered(g, static_cast<std::uint32_t>(paths));
        REQUIRE(scattered.all.count == paths);
        const double share = (1 - std::abs(g)) / std::pow(1 + std::abs(g), 2),
                     off = scattered.even.count / paths - share, error = std::sqrt(share * (1 - share) / paths);
        INFO("g " << g << ": " << scattered.even.count / paths << " even for " << share);
        // One path of 10,000 is scattered twice.
        CHECK(std::abs(off) < 4 * error + 1e-4);
        CHECK(std::abs(off + 0.05 * share) > 4 * error + 1e-4);
        // All together are Henyey and Greenstein's, whose moments are g and g^2; even ones have none.
        CHECK(std::abs(scattered.all.off(1, g)) < 4);
        CHECK(std::abs(scattered.all.off(2, g * g)) < 4);
        CHECK(std::abs(scattered.even.off(1, 0)) < 4);
        CHECK(std::abs(scattered.even.off(2, 0)) < 4);
    }
}

TEST_CASE("what leaves a sphere is as much, and as steep, as if every scattering had been walked to") {
    const std::array<double, 4> radii{0.7, 1, 1.4, 2};
    const std::array<double, 2> albedos{0.9997, 0.97};
    for (const double g : {0.4, 0.0, -0.3}) {
        const auto all_left = walked(9, albedos, g, std::array{radii[0], radii[3]}, 20000);
        for (const std::size_t k : {0u, 1u}) {
            const double albedo = albedos[k];
            const FirstPassage passage(Medium{9 * (1 - albedo), 9 * albedo}, g, radii);
            REQUIRE(passage.first() == 0);
            for (const std::size_t i : {0u, 3u}) {
                const Left& left = all_left[i == 0 ? 0 : 1][k];
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
}

TEST_CASE("resins that scatter forward lose no more in a sphere than walks say") {
    const std::array<double, 4> radii{0.7, 1, 1.4, 2};
    for (const double g : {0.8, 0.9}) {
        const FirstPassage passage(Medium{0.09, 8.91}, g, radii);
        const Left left = walked(9, std::array{0.99}, g, std::array{radii[3]}, 20000)[0][0];
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

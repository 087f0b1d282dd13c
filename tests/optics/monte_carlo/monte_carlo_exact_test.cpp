// SPDX-License-Identifier: GPL-3.0-or-later
//
// Monte Carlo against the exact solution of plane-parallel layers, as z-tests: (estimate - exact) / standard error is a
// standard normal number where the tracer is right. Every slab draws so many paths that a tracer which is 3 % wrong
// about it would be found out by its three channels together, which are three pairs of coefficients with random numbers
// of their own; one that is 2 % wrong about all of them is found out by the sum of all z^2.
#include <catch2/catch.hpp>

#include <cmath>
#include <vector>

#include "optics/monte_carlo/monte_carlo.h"
#include "tests/optics/transport/slab_scene.h"

using namespace voxtone;
using namespace voxtone::optics;
using namespace voxtone::optics::testing;

namespace {

// A thousandth of all runs of these tests with other seeds may fail: 2 (1 - Phi(z)) * (108 channels + 36 slabs) = 1e-3.
constexpr int tests = 108;
constexpr double largest_z = 4.5;
// So that 3 % of a slab lie beyond largest_z by three more standard errors.
constexpr int channels = 3;
constexpr double fault = 0.03, fault_of_all = 0.02;
const double relative_error = std::sqrt(double(channels)) * fault / (largest_z + 3);

/// The z of a slab's channels, and what they would be of a tracer that is wrong by `fault`.
class SlabScore {
public:
    void add(double value, double exact, double sigma) {
        z_ += (value - exact) / sigma;
        high_ += (value * (1 + fault) - exact) / (sigma * (1 + fault));
        low_ += (value * (1 - fault) - exact) / (sigma * (1 - fault));
    }
    void check(double most_z) const {
        const double root = std::sqrt(double(channels));
        CHECK(std::abs(z_) / root < most_z);
        CHECK(high_ / root > most_z);
        CHECK(low_ / root < -most_z);
    }

private:
    double z_ = 0, high_ = 0, low_ = 0;
};

// Roles C M Y K W of vero_opaque, then mixtures from 6 on.
const ResinSet& resins() {
    static const ResinSet set = with_mixtures(vero_opaque(), {{0.5, 0, 0, 0, 0.5},
                                                              {0, 0.5, 0.5, 0, 0},
                                                              {0.3, 0.3, 0.4, 0, 0},
                                                              {0, 0, 0.1, 0, 0.9},
                                                              {0, 0, 0, 0.05, 0.95},
                                                              {0, 0.02, 0, 0, 0.98},
                                                              {0.2, 0.2, 0.2, 0.2, 0.2}});
    return set;
}

/// Of all channels of all slabs: sums of z^2, and what they would be of a tracer that is wrong by `fault_of_all`.
class Score {
public:
    void add(double value, double exact, double sigma) {
        const auto z = [&](double wrong) { return (value * wrong - exact) / (sigma * wrong); };
        squares_ += std::pow(z(1), 2), high_ += std::pow(z(1 + fault_of_all), 2),
            low_ += std::pow(z(1 - fault_of_all), 2);
        ++done_;
    }
    /// Chi-squared of so many degrees of freedom, within four of its standard deviations.
    void check(int wanted) const {
        CHECK(done_ == wanted);
        const double most = 4 * std::sqrt(2.0 * wanted);
        CHECK(std::abs(squares_ - wanted) < most);
        CHECK(high_ - wanted > most);
        CHECK(low_ - wanted > most);
    }

private:
    int done_ = 0;
    double squares_ = 0, high_ = 0, low_ = 0;
};

void compare(const std::vector<SlabLayer>& slab, Backing backing, Score& score) {
    // How many paths the wanted error takes is found with paths that are then not used.
    const Appearance pilot = slab_appearance(MonteCarlo({.paths = 20000, .seed = 77}), resins(), slab, backing);
    SlabScore of_slab;
    for (std::size_t c = 0; c < channels; ++c) {
        const double exact = exact_appearance(resins(), slab, backing, c);
        ResinSet channel = resins();  // this channel alone
        channel.channels.wavelengths_nm = {550};
        for (Resin& resin : channel.resins) {
            resin.sigma_t_per_mm = {resin.sigma_t_per_mm[c]};
            resin.albedo = {resin.albedo[c]};
        }
        const double ratio = pilot.standard_error[c] / (relative_error * exact);
        const auto paths = static_cast<std::uint32_t>(std::max(1000.0, 20000 * ratio * ratio * 1.2));
        const Appearance traced =
            slab_appearance(MonteCarlo({.paths = paths, .seed = 5 + c, .first_path = 1000000}), channel, slab, backing);
        const double sigma = std::hypot(traced.standard_error[0], 1e-6);
        const double z = (traced.value[0] - exact) / sigma;
        INFO("top layer " << int(slab[0].material) << " x " << slab[0].voxels << ", " << slab.size()
                          << " layers, backing " << int(backing) << ", channel " << c << ": " << traced.value[0]
                          << " +- " << sigma << ", exact " << exact << ", " << paths << " paths");
        CHECK(std::abs(z) < largest_z);
        of_slab.add(traced.value[0], exact, sigma);
        score.add(traced.value[0], exact, sigma);
    }
    INFO("top layer " << int(slab[0].material) << " x " << slab[0].voxels << ", backing " << int(backing));
    of_slab.check(largest_z);
}

}  // namespace

TEST_CASE("Homogeneous and layered slabs agree with the exact solution") {
    Score score;
    const Backing backings[3]{Backing::black, Backing::white, Backing::none};
    for (Material m = 1; m <= 12; ++m) {
        compare({{m, 7}}, backings[m % 3], score);          // 0.19 mm
        compare({{m, 111}}, backings[(m + 1) % 3], score);  // 3 mm
    }
    const std::vector<std::vector<SlabLayer>> layered{
        {{1, 6}, {5, 60}}, {{3, 3}, {2, 4}, {5, 40}}, {{2, 3}, {3, 4}, {5, 40}},
        {{4, 1}, {5, 30}}, {{5, 5}, {4, 20}},         {{12, 10}, {8, 2}, {1, 1}, {5, 10}, {7, 3}}};
    for (std::size_t i = 0; i < layered.size(); ++i) {
        compare(layered[i], backings[i % 3], score);
        compare(layered[i], backings[(i + 1) % 3], score);
    }
    score.check(tests);
}

TEST_CASE("Reflectance from 45 degrees to the normal agrees with the exact solution") {
    // 2 (1 - Phi(z)) * (24 channels + 8 slabs) = 1e-3
    const double most_z = 4.2, wanted = std::sqrt(double(channels)) * fault / (most_z + 3);
    const Backing backings[3]{Backing::black, Backing::white, Backing::none};
    Score score;
    const std::vector<std::vector<SlabLayer>> slabs{{{1, 7}},  {{2, 25}}, {{3, 7}},          {{4, 7}},
                                                    {{5, 30}}, {{10, 7}}, {{1, 6}, {5, 15}}, {{5, 5}, {4, 9}}};
    for (std::size_t i = 0; i < slabs.size(); ++i) {
        const ResinVolume volume = slab_volume(slabs[i]);
        const Scene scene{&volume, &resins(), backings[i % 3], Sides::mirrored};
        const Surface surface = find_surface(scene, {volume.size()[0], volume.size()[1], 1}, SurfacePart::top);
        MonteCarloSummary summary;
        const Appearance pilot = MonteCarlo({.paths = 3000, .seed = 77}).reflectance_45_0(scene, surface, summary);
        SlabScore of_slab;
        for (std::size_t c = 0; c < channels; ++c) {
            const double exact = exact_45_0(resins(), slabs[i], scene.backing, c);
            ResinSet channel = resins();
            channel.channels.wavelengths_nm = {550};
            for (Resin& resin : channel.resins) {
                resin.sigma_t_per_mm = {resin.sigma_t_per_mm[c]};
                resin.albedo = {resin.albedo[c]};
            }
            const Scene one{&volume, &channel, scene.backing, Sides::mirrored};
            const double ratio = pilot.standard_error[c] / (wanted * exact);
            const auto paths = static_cast<std::uint32_t>(std::max(1000.0, 3000 * ratio * ratio * 1.3));
            const Appearance traced = MonteCarlo({.paths = paths, .seed = 1 + c, .first_path = 100000})
                                          .reflectance_45_0(one, surface, summary);
            const double sigma = std::hypot(traced.standard_error[0], 2e-6), z = (traced.value[0] - exact) / sigma;
            INFO("slab " << i << ", channel " << c << ": " << traced.value[0] << " +- " << sigma << ", exact " << exact
                         << ", " << paths << " paths");
            CHECK(std::abs(z) < most_z);
            of_slab.add(traced.value[0], exact, sigma);
            score.add(traced.value[0], exact, sigma);
        }
        INFO("slab " << i);
        of_slab.check(most_z);
    }
    score.check(24);
}

TEST_CASE("Packets trace what the plain loop traces") {
    // Clear and scattering resins, holes, thin walls, an overhang, a sheet below: voxel by voxel against boxes.
    ResinSet set = vero_opaque();
    set.resins.push_back({"clear", "T", {0, 0, 0}, {1, 1, 1}});
    const ResinVolume volume = make_resin_volume({36, 19, 50}, slab_pitch_mm, [](int x, int y, int z) {
        const int outer = (x - 18) * (x - 18) + 4 * (y - 9) * (y - 9) + (z - 25) * (z - 25);
        if (outer > 500 && z > 4) return 0;
        if (z > 20 && z < 30 && x > 15 && x < 20) return 0;
        if (z < 5) return 6;
        return x > 18 ? 5 : 1 + (x / 3 + y / 2 + z / 4) % 6;
    });
    for (const Backing backing : {Backing::none, Backing::white, Backing::black}) {
        const Scene scene{&volume, &set, backing, Sides::open};
        const Surface surface = find_surface(scene, {8, 4, 12}, SurfacePart::all);
        const Appearance packets = MonteCarlo({.paths = 3000}).predict(scene, surface);
        const Appearance plain =
            MonteCarlo({.paths = 3000, .seed = 9, .tracer = PathTracer::scalar}).predict(scene, surface);
        double sum = 0, variance = 0, sum_of_squares = 0, total = 0;
        int n = 0;
        for (std::size_t i = 0; i < plain.value.size(); ++i) {
            const double difference = static_cast<double>(packets.value[i]) - static_cast<double>(plain.value[i]);
            const double v = std::pow(packets.standard_error[i], 2) + std::pow(plain.standard_error[i], 2);
            sum += difference;
            variance += v;
            total += plain.value[i];
            if (plain.value[i] < 0.02f) continue;  // too few paths for a normal distribution
            sum_of_squares += difference * difference / v;
            ++n;
        }
        INFO(sum << " +- " << std::sqrt(variance) << " of " << total << ", chi squared " << sum_of_squares << " of "
                 << n);
        CHECK(std::abs(sum) < 4 * std::sqrt(variance));
        CHECK(0.02 * total > 8 * std::sqrt(variance));  // 2 % would be seen
        CHECK(std::abs(sum_of_squares - n) < 4 * std::sqrt(2.0 * n));
    }
}

TEST_CASE("Reciprocity: as much light passes a halftone one way as the other") {
    // What a lit far side adds to the appearance is the transmittance. Turned upside down the reflectance is another
    // one.
    const ResinSet set = vero_opaque();
    const auto resin = [](int x, int y, int z) {
        return z < 3 ? 2 + (x + y) % 2 : z < 9 ? 5 : (x / 2 + y) % 3 == 0 ? 1 : 5;
    };
    const int layers = 13;
    std::array<double, 3> transmitted[2], variance[2], reflected[2];
    for (const bool turned : {false, true}) {
        const ResinVolume volume = make_resin_volume({12, 6, layers}, slab_pitch_mm, [&](int x, int y, int z) {
            return resin(x, y, turned ? layers - 1 - z : z);
        });
        const auto see = [&](Backing backing, std::uint64_t seed) {
            const Scene scene{&volume, &set, backing, Sides::mirrored};
            return MonteCarlo({.paths = 500000, .seed = seed})
                .predict(scene, find_surface(scene, {12, 6, 1}, SurfacePart::top));
        };
        const Appearance lit = see(Backing::none, 1 + turned), dark = see(Backing::black, 3 + turned);
        for (std::size_t c = 0; c < 3; ++c) {
            transmitted[turned][c] = static_cast<double>(lit.value[c]) - static_cast<double>(dark.value[c]);
            variance[turned][c] = std::pow(lit.standard_error[c], 2) + std::pow(dark.standard_error[c], 2);
            reflected[turned][c] = dark.value[c];
        }
    }
    for (std::size_t c = 0; c < 3; ++c) {
        const double sigma = std::sqrt(variance[0][c] + variance[1][c]);
        INFO(c << ": " << transmitted[0][c] << " and " << transmitted[1][c] << " +- " << sigma);
        CHECK(std::abs(transmitted[0][c] - transmitted[1][c]) < 3.6 * sigma);  // three tests, one in a thousand
        CHECK(std::abs(1.05 * transmitted[0][c] - transmitted[1][c]) > 3.6 * sigma);
        CHECK(std::abs(reflected[0][c] - reflected[1][c]) > 10 * sigma);
    }
}

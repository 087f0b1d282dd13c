// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/media/effective_medium.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "optics/layered/shell_appearance.h"

using namespace voxtone;
using namespace voxtone::optics;

namespace {

constexpr std::array<double, 3> j750{25.4 / 600, 25.4 / 300, 0.027};

std::vector<double> random_fractions(RandomStream& random, std::size_t resins) {
    std::vector<double> fractions(resins);
    double sum = 0;
    for (double& f : fractions) sum += f = std::pow(-std::log(1 - random.uniform()), 3);
    for (double& f : fractions) f /= sum;
    return fractions;
}

/// Random resins: sigma_t from 0.5 to 40 per mm, albedos near 0, near 1 and between.
ResinSet random_resins(std::uint64_t seed, std::size_t count) {
    RandomStream random(seed, 1);
    ResinSet set;
    for (std::size_t r = 0; r < count; ++r) {
        Resin resin;
        resin.name = resin.role = std::string(1, static_cast<char>('a' + r));
        for (int c = 0; c < 3; ++c) {
            resin.sigma_t_per_mm.push_back(0.5 * std::pow(80.0, random.uniform()));
            const double u = random.uniform();
            resin.albedo.push_back(random.bits() % 2 == 0 ? u : 1 - std::pow(10.0, -4 * u));
        }
        set.resins.push_back(resin);
    }
    return set;
}

}  // namespace

TEST_CASE("Without voxels, or with voxels of vanishing size, mixtures are ideal") {
    const ResinSet set = vero_opaque();
    const EffectiveMedium none(set, {0, 0, 0}), tiny(set, {4e-8, 8e-8, 3e-8}), voxels(set, j750);
    CHECK(none.ideal());
    RandomStream random(1, 2);
    double largest = 0;
    for (int trial = 0; trial < 50; ++trial) {
        const std::vector<double> f = random_fractions(random, 5);
        for (std::size_t c = 0; c < 3; ++c) {
            const Medium ideal = set.mix(f, c);
            CHECK(none(f, c).sigma_a == Approx(ideal.sigma_a).epsilon(1e-14));
            CHECK(none(f, c).sigma_s == Approx(ideal.sigma_s).epsilon(1e-14));
            CHECK(tiny(f, c).sigma_a == Approx(ideal.sigma_a).epsilon(1e-5));
            CHECK(tiny(f, c).sigma_s == Approx(ideal.sigma_s).epsilon(1e-5));
            // Voxels hide absorption from light, never add to it.
            CHECK(voxels(f, c).sigma_a <= ideal.sigma_a * (1 + 1e-12));
            largest = std::max(largest, 1 - voxels(f, c).sigma_a / ideal.sigma_a);
        }
    }
    CHECK(largest > 0.1);
}

TEST_CASE("A resin alone, or beside its equals, is itself, equal resins may be told apart or not") {
    ResinSet set = random_resins(5, 4);
    set.resins[2].sigma_t_per_mm = set.resins[0].sigma_t_per_mm;
    set.resins[2].albedo = set.resins[0].albedo;
    const EffectiveMedium voxels(set, j750);
    for (std::size_t c = 0; c < 3; ++c) {
        const Medium alone = set.resins[0].medium(c);
        for (const std::vector<double>& f : {std::vector<double>{1, 0, 0, 0}, {0.3, 0, 0.7, 0}}) {
            CHECK(voxels(f, c).sigma_a == Approx(alone.sigma_a).epsilon(1e-12));
            CHECK(voxels(f, c).sigma_s == Approx(alone.sigma_s).epsilon(1e-12));
        }
        const Medium one = voxels(std::vector<double>{0.5, 0.3, 0, 0.2}, c),
                     two = voxels(std::vector<double>{0.1, 0.3, 0.4, 0.2}, c);
        CHECK(one.sigma_a == Approx(two.sigma_a).epsilon(1e-12));
        CHECK(one.sigma_s == Approx(two.sigma_s).epsilon(1e-12));
    }
}

TEST_CASE("A body seen from all sides lies between its views along the axes, cubes look the same from everywhere") {
    const ResinSet set = random_resins(6, 4);
    const std::vector<double> f{0.2, 0.4, 0.1, 0.3};
    const std::array<double, 3> cube{0.04, 0.04, 0.04};
    for (std::size_t c = 0; c < 3; ++c) {
        const auto along = [&](std::size_t up) {
            return EffectiveMedium(set, {j750[(up + 1) % 3], j750[(up + 2) % 3], j750[up]})(f, c);
        };
        const Medium x = along(0), y = along(1), z = along(2),
                     all = EffectiveMedium(set, j750, SeenFrom::all_sides)(f, c);
        CHECK(all.sigma_a > std::min({x.sigma_a, y.sigma_a, z.sigma_a}));
        CHECK(all.sigma_a < std::max({x.sigma_a, y.sigma_a, z.sigma_a}));
        CHECK(all.sigma_s > std::min({x.sigma_s, y.sigma_s, z.sigma_s}));
        CHECK(all.sigma_s < std::max({x.sigma_s, y.sigma_s, z.sigma_s}));
        CHECK(EffectiveMedium(set, cube, SeenFrom::all_sides)(f, c).sigma_s ==
              Approx(EffectiveMedium(set, cube)(f, c).sigma_s).epsilon(1e-12));
    }
}

TEST_CASE("Resins that absorb nothing make a medium that absorbs nothing") {
    ResinSet set = vero_opaque();
    for (Resin& resin : set.resins) resin.albedo = {1, 1, 1};
    const EffectiveMedium voxels(set, j750);
    const std::vector<double> f{0.1, 0.2, 0.3, 0.15, 0.25};
    for (std::size_t c = 0; c < 3; ++c) CHECK(voxels(f, c).sigma_a == 0);
}

TEST_CASE("The effective medium's derivatives are its slopes, and its bound holds") {
    const ResinSet set = random_resins(7, 5);
    for (const std::array<double, 3>& pitch :
         {j750, std::array<double, 3>{0.085, 0.085, 0.019}, {0.05, 0.05, 0.05}, {0, 0, 0}}) {
        const EffectiveMedium medium(set, pitch);
        RandomStream random(3, 4);
        for (int trial = 0; trial < 40; ++trial) {
            const std::vector<double> f = random_fractions(random, 5);
            for (std::size_t c = 0; c < 3; ++c) {
                const EffectiveMedium::Point at = medium.at(f, c);
                CHECK(at.medium.sigma_a <= medium.bound(c).sigma_a);
                CHECK(at.medium.sigma_s <= medium.bound(c).sigma_s);
                std::vector<double> by_a(5), by_s(5);
                medium.gradient(at, c, 1, 0, by_a);
                medium.gradient(at, c, 0, 1, by_s);
                for (std::size_t r = 0; r < 5; ++r) {
                    std::vector<double> above = f, below = f;
                    above[r] += 1e-6, below[r] -= 1e-6;
                    const Medium up = medium(above, c), down = medium(below, c);
                    CHECK(by_a[r] == Approx((up.sigma_a - down.sigma_a) / 2e-6).epsilon(1e-6).margin(1e-6));
                    CHECK(by_s[r] == Approx((up.sigma_s - down.sigma_s) / 2e-6).epsilon(1e-6).margin(1e-6));
                }
            }
        }
    }
}

TEST_CASE("A shell of voxels has a table that agrees with the exact solution and gradients that are its slopes") {
    const ResinSet set = vero_opaque();
    ShellGeometry geometry{1.0, set.find("W")};
    const ShellAppearance ideal(set, geometry);
    geometry.pitch_mm = j750;
    const ShellAppearance shell(set, geometry);
    RandomStream random(5, 6);
    double worst = 0, departure = 0;
    std::vector<double> value(3), gradient(15), above(3), below(3);
    for (int trial = 0; trial < 30; ++trial) {
        const std::vector<double> f = random_fractions(random, 5);
        shell.appearance(f, value, gradient);
        const std::vector<double> exact = shell.exact(f), averaged = ideal.appearance(f);
        for (std::size_t c = 0; c < 3; ++c) {
            worst = std::max(worst, std::abs(value[c] - exact[c]));
            departure = std::max(departure, value[c] / averaged[c] - 1);
        }
        for (std::size_t r = 0; r < 5; ++r) {
            std::vector<double> moved = f;
            moved[r] += 1e-6;
            shell.appearance(moved, above);
            moved[r] -= 2e-6;
            shell.appearance(moved, below);
            // As in shell_appearance_test.cpp.
            for (std::size_t c = 0; c < 3; ++c)
                CHECK(gradient[c * 5 + r] == Approx((above[c] - below[c]) / 2e-6).epsilon(1e-4).margin(1e-5));
        }
    }
    CHECK(worst < 1e-4);
    CHECK(departure > 0.1);
}

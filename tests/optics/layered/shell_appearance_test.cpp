// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/layered/shell_appearance.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "base/random.h"

using namespace voxtone;
using namespace voxtone::optics;

namespace {

// Shares drawn so that nearly pure resins and traces are as common as even mixtures.
std::vector<double> random_fractions(RandomStream& random, std::size_t resins) {
    std::vector<double> fractions(resins);
    double sum = 0;
    for (double& f : fractions) sum += f = std::pow(-std::log(1 - random.uniform()), 3);
    for (double& f : fractions) f /= sum;
    return fractions;
}

ResinSet with_clear(ResinSet set) {
    set.resins.push_back({"VeroClear", "T", {0, 0, 0}, {1, 1, 1}});
    return set;
}

double worst_table_error(const ResinSet& set, const ShellGeometry& geometry, int trials) {
    const ShellAppearance shell(set, geometry);
    RandomStream random(1, 2);
    double worst = 0;
    for (int trial = 0; trial < trials; ++trial) {
        const std::vector<double> fractions = random_fractions(random, shell.resins());
        const std::vector<double> table = shell.appearance(fractions), exact = shell.exact(fractions);
        for (std::size_t c = 0; c < table.size(); ++c) worst = std::max(worst, std::abs(table[c] - exact[c]));
    }
    return worst;
}

}  // namespace

TEST_CASE("The shell's table agrees with the exact solution", "[slow]") {
    const ResinSet set = vero_opaque();
    const int white = set.find("W");
    ShellGeometry geometry{1.0, white};
    CHECK(worst_table_error(set, geometry, 40) < 1e-4);
    CHECK(worst_table_error(with_clear(set), geometry, 40) < 1e-4);
    geometry.shell_mm = 0.3;
    geometry.core_mm = 2.4;
    for (const Backing backing : {Backing::none, Backing::black, Backing::white}) {
        geometry.backing = backing;
        CHECK(worst_table_error(with_clear(set), geometry, 20) < 1e-4);
    }
}

TEST_CASE("Clear resin over and under a shell, and light from behind, are as the exact solution has them", "[slow]") {
    ResinSet set = with_clear(vero_opaque());
    ShellGeometry geometry{0.3, set.find("W"), 0.4, Backing::black};
    geometry.clear_resin = set.find("T");
    geometry.over_mm = 1, geometry.under_mm = 0.5;
    CHECK(worst_table_error(set, geometry, 20) < 1e-4);
    const std::vector<double> half{0.2, 0, 0.3, 0, 0.5, 0};
    ShellGeometry bare = geometry;
    bare.over_mm = bare.under_mm = 0;
    // What neither absorbs nor scatters is nothing to flat colours.
    const std::vector<double> with = ShellAppearance(set, geometry).appearance(half),
                              without = ShellAppearance(set, bare).appearance(half);
    for (std::size_t c = 0; c < 3; ++c) CHECK(with[c] == Approx(without[c]).margin(1e-12));
    geometry.from_behind = true;
    CHECK(worst_table_error(set, geometry, 20) < 1e-4);
    // A clear resin that absorbs takes its part, in white as in colours.
    set.resins.back() = {"Yellowish", "T", {0.02, 0.02, 0.1}, {0, 0, 0}};
    CHECK(worst_table_error(set, geometry, 20) < 1e-4);
    geometry.from_behind = false;
    const ShellAppearance yellowish(set, geometry);
    CHECK(worst_table_error(set, geometry, 20) < 1e-4);
    CHECK(yellowish.appearance(half)[2] < 0.9 * without[2]);
    for (const double value : yellowish.media_relative(std::vector<double>{0, 0, 0, 0, 1, 0}))
        CHECK(value == Approx(1).margin(2e-5));
}

TEST_CASE("What a slab that absorbs nothing does not send back comes through from behind") {
    ResinSet set = with_clear(vero_opaque().subset(std::vector<std::string>{"W"}));
    set.resins[0].albedo = {1, 1, 1};
    ShellGeometry geometry{0.5, 0, 0.7, Backing::black};
    const std::vector<double> white{1, 0};
    const std::vector<double> back = ShellAppearance(set, geometry).appearance(white);
    geometry.from_behind = true;
    const std::vector<double> through = ShellAppearance(set, geometry).appearance(white);
    for (std::size_t c = 0; c < 3; ++c) {
        CHECK((through[c] > 0.02 && through[c] < 0.5));
        CHECK(through[c] + back[c] == Approx(1).margin(1e-6));
    }
}

TEST_CASE("A shell of core resin is media-relative white, and nothing that is darker inside is brighter") {
    const ResinSet set = vero_opaque();
    const ShellAppearance shell(set, {1.0, set.find("W")});
    for (const double value : shell.media_relative(std::vector<double>{0, 0, 0, 0, 1}))
        CHECK(value == Approx(1).margin(2e-5));
    const std::vector<double> black = shell.media_relative(std::vector<double>{0, 0, 0, 1, 0});
    for (const double value : black) CHECK((value > 0.010 && value < 0.016));
    std::vector<double> previous = shell.appearance(std::vector<double>{0, 0, 0, 0, 1});
    for (int i = 1; i <= 100; ++i) {
        const std::vector<double> darker = shell.appearance(std::vector<double>{0, 0, 0, i / 100.0, 1 - i / 100.0});
        for (std::size_t c = 0; c < 3; ++c) CHECK(darker[c] < previous[c]);
        previous = darker;
    }
}

TEST_CASE("The gradient of the shell's appearance is the slope of its values") {
    const ResinSet set = with_clear(vero_opaque());
    const ShellAppearance shell(set, {1.0, set.find("W")});
    RandomStream random(3, 4);
    std::vector<double> value(3), gradient(3 * shell.resins()), above(3), below(3);
    for (int trial = 0; trial < 50; ++trial) {
        const std::vector<double> fractions = random_fractions(random, shell.resins());
        shell.media_relative(fractions, value, gradient);
        shell.media_relative(fractions, above);
        for (std::size_t c = 0; c < 3; ++c) CHECK(value[c] == Approx(above[c]).margin(1e-14));
        for (std::size_t r = 0; r < shell.resins(); ++r) {
            const double step = 1e-6;
            std::vector<double> moved = fractions;
            moved[r] += step;
            shell.media_relative(moved, above);
            moved[r] -= 2 * step;
            shell.media_relative(moved, below);
            for (std::size_t c = 0; c < 3; ++c) {
                const double slope = (above[c] - below[c]) / (2 * step);
                // The slope reaches 50 per unit of fraction and bends over fractions of 1e-3.
                CHECK(gradient[c * shell.resins() + r] == Approx(slope).epsilon(1e-4).margin(1e-5));
            }
        }
    }
}

TEST_CASE("A shell of resins that absorb nothing has appearance 1 on every backing that loses nothing") {
    ResinSet set = vero_opaque();
    for (Resin& resin : set.resins) resin.albedo = {1, 1, 1};
    const std::vector<double> mixture{0.1, 0.2, 0.3, 0.15, 0.25};
    for (const Backing backing : {Backing::none, Backing::white}) {
        const ShellAppearance shell(set, {1.0, 4, 2.0, backing});
        for (const double value : shell.appearance(mixture)) CHECK(value == Approx(1).margin(1e-9));
    }
    const ShellAppearance deep(set, {1.0, 4});
    for (const double value : deep.appearance(mixture)) CHECK(value == Approx(1).margin(1e-9));
    const ShellAppearance lossy(set, {1.0, 4, 2.0, Backing::black});
    for (const double value : lossy.appearance(mixture)) CHECK(value < 0.95);
}

TEST_CASE("Any number of channels") {
    ResinSet set;
    set.name = "two";
    set.channels.wavelengths_nm = {450, 500, 550, 600, 650};
    set.resins = {{"a", "A", {9, 8, 7, 6, 5}, {0.1, 0.5, 0.9, 0.99, 0.3}},
                  {"w", "W", {9, 8, 7, 6, 5}, {0.999, 0.998, 0.9995, 0.9999, 1}}};
    const ShellAppearance shell(set, {0.5, 1});
    CHECK(shell.channels() == 5);
    const std::vector<double> mixture{0.3, 0.7}, table = shell.appearance(mixture), exact = shell.exact(mixture);
    for (std::size_t c = 0; c < 5; ++c) CHECK(table[c] == Approx(exact[c]).margin(1e-4));
}

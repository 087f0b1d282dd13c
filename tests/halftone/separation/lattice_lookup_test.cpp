// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <vector>

#include <hwy/targets.h>

#include "base/random.h"
#include "halftone/separation/lattice_lookup.h"
#include "halftone/separation/scalar_lookup.h"

using namespace voxtone;
using namespace voxtone::halftone;

namespace {

/// Square roots of random mixtures of `resins`.
std::vector<float> random_lattice(int nodes, int resins) {
    RandomStream random(11, static_cast<std::uint64_t>(nodes * 10 + resins));
    std::vector<float> root(static_cast<std::size_t>(nodes * nodes * nodes) * max_resins, 0.0f);
    for (std::size_t node = 0; node < root.size(); node += max_resins) {
        double sum = 0;
        std::vector<double> share(static_cast<std::size_t>(resins));
        for (double& s : share) sum += s = std::pow(random.uniform(), 3) + 1e-6;
        for (std::size_t r = 0; r < share.size(); ++r) root[node + r] = static_cast<float>(std::sqrt(share[r] / sum));
    }
    return root;
}

/// Colours in and around the cube, greys and those on nodes and borders among them; `n` is no multiple of a block.
struct RandomColours {
    explicit RandomColours(std::size_t n) : red(n), green(n), blue(n) {
        RandomStream random(12, n);
        for (std::size_t i = 0; i < n; ++i) {
            red[i] = static_cast<float>(1.2 * random.uniform() - 0.1);
            green[i] = i % 7 == 0 ? red[i] : static_cast<float>(random.uniform());
            blue[i] = i % 5 == 0 ? green[i] : static_cast<float>(std::pow(random.uniform(), 6));
        }
        const float odd[] = {0,
                             1,
                             0.125f,
                             0x1p-149f,
                             -0.0f,
                             std::numeric_limits<float>::quiet_NaN(),
                             std::numeric_limits<float>::infinity()};
        for (std::size_t i = 0; i < n && i < std::size(odd); ++i) red[i] = odd[i];
    }
    std::vector<float> red, green, blue;
};

/// Calls `check` once for every vector unit that this machine has; how many there were.
template <class Check>
int for_every_vector_unit(Check check) {
    int count = 0;
    hwy::SetSupportedTargetsForTest(0);
    for (std::int64_t targets = hwy::SupportedTargets(); targets != 0; targets &= targets - 1, ++count) {
        hwy::SetSupportedTargetsForTest(targets & -targets);
        check();
    }
    hwy::SetSupportedTargetsForTest(0);
    return count;
}

}  // namespace

TEST_CASE("Every vector unit looks colours up to the bits of the scalar definition") {
    const RandomColours colours(1003);
    const std::size_t n = colours.red.size();
    for (const int nodes : {2, 9, 33})
        for (const int resins : {1, 2, 5, 8}) {
            const std::vector<float> root = random_lattice(nodes, resins);
            const LatticeView lattice{root.data(), nodes, resins};
            const int units = for_every_vector_unit([&] {
                std::vector<CumulativeMixture> mixtures(n);
                lattice_mixtures(lattice, colours.red.data(), colours.green.data(), colours.blue.data(), n,
                                 mixtures.data());
                std::size_t other_mixtures = 0, other_shares = 0;
                for (std::size_t i = 0; i < n; ++i) {
                    const float r = colours.red[i], g = colours.green[i], b = colours.blue[i];
                    Shares shares;
                    lattice_shares(lattice, r, g, b, shares.data());
                    other_mixtures += mixtures[i].bound != scalar_mixture(lattice, r, g, b).bound;
                    other_shares += shares != scalar_shares(lattice, r, g, b);
                }
                CHECK(other_mixtures == 0);
                CHECK(other_shares == 0);
            });
            CHECK(units > 1);
        }
}

TEST_CASE("A lattice that is linear in the colours' cube roots is met between its nodes") {
    constexpr int nodes = 5;
    std::vector<float> root;
    for (int b = 0; b < nodes; ++b)
        for (int g = 0; g < nodes; ++g)
            for (int r = 0; r < nodes; ++r)
                for (std::size_t k = 0; k < max_resins; ++k)
                    root.push_back(k == 0 ? static_cast<float>(r + 2 * g + 4 * b) / 28 : 0.0f);
    const LatticeView lattice{root.data(), nodes, 2};
    const RandomColours colours(200);
    for (std::size_t i = 7; i < 200; ++i) {
        const auto axis = [](float x) { return std::cbrt(std::clamp(x, 1e-9f, 1.0f)); };
        const float r = colours.red[i], g = colours.green[i], b = colours.blue[i];
        const float wanted = (axis(r) + 2 * axis(g) + 4 * axis(b)) / 7;
        const float share = scalar_shares(lattice, r, g, b)[0];
        // The mean of the squares lies above the square of the mean by a variance: (1 / 8)^2 at most within a cell.
        CHECK(share >= wanted * wanted - 1e-5f);
        CHECK(share <= wanted * wanted + 0.5f / 64 + 1e-5f);
    }
}

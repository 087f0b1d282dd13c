// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/design/aligned_laminates.h"

#include <catch2/catch.hpp>

#include "base/random.h"

using namespace voxtone;
using namespace voxtone::scattering;
using namespace voxtone::halftone;

namespace {

using Laminate = std::vector<LaminateLayer>;

Laminate without_zeros(const AlignedLaminates& aligned, std::size_t laminate) {
    Laminate layers;
    for (std::size_t l = 0; l < aligned.layers(); ++l)
        if (aligned.thicknesses(laminate)[l] > 0)
            layers.push_back({aligned.material[l], aligned.thicknesses(laminate)[l]});
    return layers;
}

void check_same(const Laminate& a, const Laminate& b) {
    REQUIRE(a.size() == b.size());
    for (std::size_t l = 0; l < a.size(); ++l) {
        CHECK(a[l].material == b[l].material);
        CHECK(a[l].thickness_mm == b[l].thickness_mm);
    }
}

Laminate random_laminate(RandomStream& random, std::size_t materials, std::size_t most_layers) {
    Laminate laminate(std::size_t(random.uniform() * double(most_layers + 1)));
    for (std::size_t l = 0; l < laminate.size(); ++l) {
        do {
            laminate[l].material = std::size_t(random.uniform() * double(materials));
        } while (l > 0 && laminate[l].material == laminate[l - 1].material);
        laminate[l].thickness_mm = 0.01 + random.uniform();
    }
    return laminate;
}

}  // namespace

TEST_CASE("Aligned laminates are the laminates that came in, without their layers of thickness zero") {
    for (std::uint64_t trial = 0; trial < 200; ++trial) {
        RandomStream random(7, trial);
        const std::size_t materials = 2 + std::size_t(random.uniform() * 5),
                          count = 1 + std::size_t(random.uniform() * 30);
        std::vector<Laminate> laminates;
        for (std::size_t s = 0; s < count; ++s) laminates.push_back(random_laminate(random, materials, 6));
        const AlignedLaminates aligned = align_laminates(laminates);
        REQUIRE(aligned.thickness_mm.size() == count * aligned.layers());
        for (std::size_t s = 0; s < count; ++s) check_same(without_zeros(aligned, s), laminates[s]);
        for (std::size_t l = 0; l < aligned.layers(); ++l) {
            if (l > 0) CHECK(aligned.material[l] != aligned.material[l - 1]);
            bool used = false;
            for (std::size_t s = 0; s < count; ++s) used = used || aligned.thicknesses(s)[l] > 0;
            CHECK(used);
        }
        CHECK(aligned.layers() <= 6 * materials);  // each layer finds its place within the next period
    }
}

TEST_CASE("Laminates of one sequence of materials need no layers of thickness zero") {
    const std::vector<Laminate> laminates{{{4, 0.1}, {2, 0.2}, {4, 0.3}}, {{4, 1}, {2, 2}, {4, 3}}};
    const AlignedLaminates aligned = align_laminates(laminates);
    CHECK(aligned.material == std::vector<std::size_t>{4, 2, 4});
    CHECK(aligned.thickness_mm == std::vector<double>{0.1, 0.2, 0.3, 1, 2, 3});
}

TEST_CASE("The order of the period is the one that needs fewest layers") {
    // White over black, white alone, black alone; then a laminate that begins with black.
    CHECK(align_laminates(std::vector<Laminate>{{{0, 1}, {1, 1}}, {{0, 1}}, {{1, 1}}}).material ==
          std::vector<std::size_t>{0, 1});
    CHECK(align_laminates(std::vector<Laminate>{{{1, 1}, {0, 1}}, {{0, 1}}}).material ==
          std::vector<std::size_t>{1, 0});
    CHECK(align_laminates(std::vector<Laminate>{{{0, 1}, {1, 1}}, {{1, 1}, {0, 1}}}).layers() == 3);
}

TEST_CASE("No laminate and laminates without layers align to nothing") {
    CHECK(align_laminates(std::vector<Laminate>{}).layers() == 0);
    const AlignedLaminates aligned = align_laminates(std::vector<Laminate>{{}, {}});
    CHECK(aligned.layers() == 0);
    CHECK(aligned.thicknesses(1).empty());
    const AlignedLaminates one = align_laminates(std::vector<Laminate>{{}, {{3, 0.5}}});
    CHECK(one.material == std::vector<std::size_t>{3});
    CHECK(one.thickness_mm == std::vector<double>{0, 0.5});
}

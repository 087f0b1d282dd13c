// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/stacks/aligned_stacks.h"

#include <catch2/catch.hpp>

#include "base/random.h"

using namespace voxtone;
using namespace voxtone::halftone;

namespace {

using Stack = std::vector<StackLayer>;

Stack without_zeros(const AlignedStacks& aligned, std::size_t stack) {
    Stack layers;
    for (std::size_t l = 0; l < aligned.layers(); ++l)
        if (aligned.thicknesses(stack)[l] > 0) layers.push_back({aligned.material[l], aligned.thicknesses(stack)[l]});
    return layers;
}

void check_same(const Stack& a, const Stack& b) {
    REQUIRE(a.size() == b.size());
    for (std::size_t l = 0; l < a.size(); ++l) {
        CHECK(a[l].material == b[l].material);
        CHECK(a[l].thickness_mm == b[l].thickness_mm);
    }
}

Stack random_stack(RandomStream& random, std::size_t materials, std::size_t most_layers) {
    Stack stack(std::size_t(random.uniform() * double(most_layers + 1)));
    for (std::size_t l = 0; l < stack.size(); ++l) {
        do {
            stack[l].material = std::size_t(random.uniform() * double(materials));
        } while (l > 0 && stack[l].material == stack[l - 1].material);
        stack[l].thickness_mm = 0.01 + random.uniform();
    }
    return stack;
}

}  // namespace

TEST_CASE("Aligned stacks are the stacks that came in, without their layers of thickness zero") {
    for (std::uint64_t trial = 0; trial < 200; ++trial) {
        RandomStream random(7, trial);
        const std::size_t materials = 2 + std::size_t(random.uniform() * 5),
                          count = 1 + std::size_t(random.uniform() * 30);
        std::vector<Stack> stacks;
        for (std::size_t s = 0; s < count; ++s) stacks.push_back(random_stack(random, materials, 6));
        const AlignedStacks aligned = align_stacks(stacks);
        REQUIRE(aligned.thickness_mm.size() == count * aligned.layers());
        for (std::size_t s = 0; s < count; ++s) check_same(without_zeros(aligned, s), stacks[s]);
        for (std::size_t l = 0; l < aligned.layers(); ++l) {
            if (l > 0) CHECK(aligned.material[l] != aligned.material[l - 1]);
            bool used = false;
            for (std::size_t s = 0; s < count; ++s) used = used || aligned.thicknesses(s)[l] > 0;
            CHECK(used);
        }
        CHECK(aligned.layers() <= 6 * materials);  // each layer finds its place within the next period
    }
}

TEST_CASE("Stacks of one sequence of materials need no layers of thickness zero") {
    const std::vector<Stack> stacks{{{4, 0.1}, {2, 0.2}, {4, 0.3}}, {{4, 1}, {2, 2}, {4, 3}}};
    const AlignedStacks aligned = align_stacks(stacks);
    CHECK(aligned.material == std::vector<std::size_t>{4, 2, 4});
    CHECK(aligned.thickness_mm == std::vector<double>{0.1, 0.2, 0.3, 1, 2, 3});
}

TEST_CASE("The order of the period is the one that needs fewest layers") {
    // White over black, white alone, black alone; then a stack that begins with black.
    CHECK(align_stacks(std::vector<Stack>{{{0, 1}, {1, 1}}, {{0, 1}}, {{1, 1}}}).material ==
          std::vector<std::size_t>{0, 1});
    CHECK(align_stacks(std::vector<Stack>{{{1, 1}, {0, 1}}, {{0, 1}}}).material == std::vector<std::size_t>{1, 0});
    CHECK(align_stacks(std::vector<Stack>{{{0, 1}, {1, 1}}, {{1, 1}, {0, 1}}}).layers() == 3);
}

TEST_CASE("No stack and stacks without layers align to nothing") {
    CHECK(align_stacks(std::vector<Stack>{}).layers() == 0);
    const AlignedStacks aligned = align_stacks(std::vector<Stack>{{}, {}});
    CHECK(aligned.layers() == 0);
    CHECK(aligned.thicknesses(1).empty());
    const AlignedStacks one = align_stacks(std::vector<Stack>{{}, {{3, 0.5}}});
    CHECK(one.material == std::vector<std::size_t>{3});
    CHECK(one.thickness_mm == std::vector<double>{0, 0.5});
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <cmath>

#include "base/error.h"
#include "random_layers.h"
#include "scattering/design/laminate_refinement.h"

using namespace voxtone;
using namespace voxtone::scattering;

namespace {

double total_mm(const std::vector<LaminateLayer>& layers) {
    double mm = 0;
    for (const LaminateLayer& layer : layers) mm += layer.thickness_mm;
    return mm;
}

}  // namespace

TEST_CASE("refinement never makes a laminate worse and keeps the limits", "[slow]") {
    double before = 0, after = 0;
    int at_limit = 0, converged = 0;
    constexpr int trials = 120;
    for (std::uint64_t trial = 0; trial < trials; ++trial) {
        RandomStream random(40, trial);
        const std::size_t channels = 1 + trial % 3;
        const std::vector<LaminateMaterial> materials = random_materials(random, 3, channels, 12);
        LaminateSearchOptions options;
        options.thickness_mm = trial % 2 == 0 ? 5 : 0.8;
        options.steps = 16;
        options.dc_weight = trial % 5 == 0 ? 10 : 1;
        if (trial % 3 == 0) options.clear_top_mm = {0, 0.2, 0.3};
        if (trial % 4 == 0) options.backing.assign(channels, std::vector<double>(12, 0.3));
        const ChannelProfiles target = random_target(random, channels, 12);
        const FoundLaminate found = LaminateSearch(materials, options).find(target);
        const RefinedLaminate refined = refine_laminate(materials, found.layers, target, options);
        CHECK(refined.distance_before == Approx(found.distance).epsilon(1e-9));
        CHECK(refined.distance <= refined.distance_before);
        CHECK(profile_distance(laminate_reflection(materials, refined.layers, options.backing), target,
                               options.dc_weight) == Approx(refined.distance).margin(1e-12));
        CHECK(total_mm(refined.layers) <= options.thickness_mm + 1e-8);
        double depth = 0;
        for (const LaminateLayer& layer : refined.layers) {
            CHECK(layer.thickness_mm > 0);
            if (!options.clear_top_mm.empty()) CHECK(depth >= options.clear_top_mm[layer.material] - 1e-8);
            depth += layer.thickness_mm;
        }
        at_limit += total_mm(refined.layers) > options.thickness_mm - 1e-6;
        converged += refined.converged;
        before += refined.distance_before;
        after += refined.distance;
        // No small change of one thickness within the limits is better.
        if (!options.clear_top_mm.empty()) continue;
        for (std::size_t j = 0; j < refined.layers.size(); ++j)
            for (const double by : {-1e-3, 1e-3}) {
                std::vector<LaminateLayer> changed = refined.layers;
                changed[j].thickness_mm += by;
                if (changed[j].thickness_mm < 0 || total_mm(changed) > options.thickness_mm) continue;
                const double distance = profile_distance(laminate_reflection(materials, changed, options.backing),
                                                         target, options.dc_weight);
                CHECK(distance >= refined.distance - 1e-7);
            }
    }
    INFO("mean distance " << before / trials << " before, " << after / trials << " after");
    CHECK(after < 0.97 * before);
    CHECK(at_limit > 5);
    CHECK(converged > 0.95 * trials);
}

TEST_CASE("thicknesses between the steps come back") {
    RandomStream random(41, 0);
    const std::vector<LaminateMaterial> materials = random_materials(random, 3, 2, 16);
    const std::vector<LaminateLayer> wanted{{0, 0.137}, {1, 0.271}, {2, 0.419}};
    const ChannelProfiles target = laminate_reflection(materials, wanted, {});
    const std::vector<LaminateLayer> start{{0, 0.1}, {1, 0.3}, {2, 0.4}};
    const RefinedLaminate refined = refine_laminate(materials, start, target, {});
    CHECK(refined.distance < 1e-9);
    REQUIRE(refined.layers.size() == 3);
    for (std::size_t j = 0; j < 3; ++j)
        CHECK(refined.layers[j].thickness_mm == Approx(wanted[j].thickness_mm).epsilon(1e-4));
}

TEST_CASE("a layer that only does harm goes, and its neighbours are joined") {
    RandomStream random(42, 0);
    const std::vector<LaminateMaterial> materials = random_materials(random, 2, 1, 10);
    const ChannelProfiles target = laminate_reflection(materials, std::vector<LaminateLayer>{{0, 0.4}}, {});
    const RefinedLaminate refined =
        refine_laminate(materials, std::vector<LaminateLayer>{{0, 0.15}, {1, 0.02}, {0, 0.2}, {1, 0}}, target, {});
    CHECK(refined.distance < 1e-6);
    double other = 0;
    for (const LaminateLayer& layer : refined.layers) other += layer.material == 1 ? layer.thickness_mm : 0;
    CHECK(other < 1e-4);
}

TEST_CASE("laminates that cannot be refined are refused or left as they are") {
    RandomStream random(43, 0);
    const std::vector<LaminateMaterial> materials = random_materials(random, 2, 1, 5);
    const ChannelProfiles target{std::vector<double>(5, 0.2)};
    const auto refine = [&](std::vector<LaminateLayer> layers, const LaminateSearchOptions& options) {
        return refine_laminate(materials, layers, target, options);
    };
    const RefinedLaminate nothing = refine({}, {});
    CHECK(nothing.layers.empty());
    CHECK(nothing.distance == Approx(0.2));
    CHECK_THROWS_AS(refine({{0, -0.1}}, {}), InputError);
    CHECK_THROWS_AS(refine({{2, 0.1}}, {}), InputError);
    CHECK_THROWS_AS(refine({{0, 6}}, {}), InputError);
    LaminateSearchOptions clear;
    clear.clear_top_mm = {0, 0.2};
    CHECK_THROWS_AS(refine({{1, 0.1}}, clear), InputError);
    CHECK_THROWS_AS(refine_laminate(materials, std::vector<LaminateLayer>{{0, 0.1}}, {std::vector<double>(4, 0.2)}, {}),
                    InputError);
}

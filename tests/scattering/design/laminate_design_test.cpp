// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/design/laminate_design.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "optics/profiles/resin_profile.h"
#include "optics/profiles/saunderson.h"
#include "random_layers.h"
#include "scattering/design/laminate_materials.h"
#include "scattering/design/whole_layers.h"

using namespace voxtone;
using namespace voxtone::scattering;

namespace {

constexpr std::size_t coefficients = 16;

double in_layers(double mm, double layer_mm) { return std::abs(mm / layer_mm - std::round(mm / layer_mm)); }

double total_mm(const std::vector<LaminateLayer>& layers) {
    double mm = 0;
    for (const LaminateLayer& layer : layers) mm += layer.thickness_mm;
    return mm;
}

LaminateSearchOptions small_search() {
    LaminateSearchOptions options;
    options.thickness_mm = 2;
    options.steps = 16;
    options.max_blocks = 4;
    return options;
}

// What is really seen: a surface, and every layer reflects as if it were an eighth thicker.
ChannelProfiles other_world(const std::vector<LaminateMaterial>& materials, std::span<const LaminateLayer> layers,
                            double s) {
    std::vector<LaminateLayer> thicker(layers.begin(), layers.end());
    for (LaminateLayer& layer : thicker) layer.thickness_mm *= 1.125;
    ChannelProfiles R = laminate_reflection(materials, thicker, {});
    for (auto& channel : R)
        for (double& value : channel) value = optics::seen_through_surface(value, s);
    return R;
}

}  // namespace

TEST_CASE(
    "Whole layers: borders move by half a printed layer at most, and materials stay as far from the top as they must") {
    const std::vector<LaminateLayer> layers{{0, 0.1}, {1, 0.004}, {0, 0.05}, {2, 0.3}};
    const std::vector<LaminateLayer> whole = whole_layers(layers, 0.027);
    REQUIRE(whole.size() == 2);  // the film vanishes, and the layers about it are one
    CHECK(whole[0].material == 0);
    CHECK(whole[0].thickness_mm == Approx(6 * 0.027));   // 0.154 mm
    CHECK(whole[1].thickness_mm == Approx(11 * 0.027));  // up to 0.454 mm
    const std::vector<double> clear{0, 0, 0.163};
    const std::vector<LaminateLayer> clear_top = whole_layers(layers, 0.027, clear);
    CHECK(clear_top[0].thickness_mm == Approx(7 * 0.027));
    CHECK(whole_layers({}, 0.027).empty());
    for (std::uint64_t trial = 0; trial < 50; ++trial) {
        RandomStream random(77, trial);
        std::vector<LaminateLayer> drawn;
        for (int i = 0; i < 5; ++i) drawn.push_back({static_cast<std::size_t>(i % 3), 0.3 * random.uniform()});
        const std::vector<LaminateLayer> printed = whole_layers(drawn, 0.014);
        CHECK(std::abs(total_mm(printed) - total_mm(drawn)) <= 0.5 * 0.014 + 1e-12);
        for (std::size_t i = 0; i < printed.size(); ++i) {
            CHECK(in_layers(printed[i].thickness_mm, 0.014) < 1e-6);
            if (i > 0) CHECK(printed[i].material != printed[i - 1].material);
        }
    }
}

TEST_CASE("Settled layers are never further from the target than rounded ones, and keep the limits") {
    int nearer = 0;
    for (std::uint64_t trial = 0; trial < 20; ++trial) {
        RandomStream random(78, trial);
        const std::vector<LaminateMaterial> materials = random_materials(random, 3, 2, coefficients);
        const ChannelProfiles target = random_target(random, 2, coefficients);
        LaminateSearchOptions options = small_search();
        options.clear_top_mm = {0, 0, 0.2};
        const std::vector<LaminateLayer> layers = LaminateSearch(materials, options).find(target).layers;
        const std::vector<LaminateLayer> rounded = whole_layers(layers, 0.1, options.clear_top_mm),
                                         settled = settled_layers(materials, layers, 0.1, target, options);
        const double before = profile_distance(laminate_reflection(materials, rounded, {}), target, 1),
                     after = profile_distance(laminate_reflection(materials, settled, {}), target, 1);
        CHECK(after <= before);
        nearer += after < before ? 1 : 0;
        CHECK(total_mm(settled) <= std::max(total_mm(rounded), options.thickness_mm) + 1e-6);
        double depth = 0;
        for (const LaminateLayer& layer : settled) {
            CHECK(in_layers(layer.thickness_mm, 0.1) < 1e-6);
            CHECK(depth >= options.clear_top_mm[layer.material] - 1e-6);
            depth += layer.thickness_mm;
        }
    }
    CHECK(nearer > 5);
}

TEST_CASE("Without a judge a design is the search, refined, behind the surface") {
    RandomStream random(79, 0);
    const std::vector<LaminateMaterial> materials = random_materials(random, 3, 1, coefficients);
    const std::vector<LaminateLayer> truth{{0, 0.3}, {2, 0.7}};
    const double s = optics::internal_diffuse_reflectance(1.5);
    ChannelProfiles wanted = laminate_reflection(materials, truth, {});
    for (double& value : wanted[0]) value = optics::seen_through_surface(value, s);
    LaminateDesignOptions options;
    options.search = small_search();
    options.turned_back = s;
    const LaminateSearch search(materials, options.search);
    const LaminateDesign design = design_laminate(search, materials, wanted, options);
    CHECK(design.modelled_distance < 0.01);
    CHECK(design.judged.empty());
    CHECK(design.judged_distances.empty());
    options.refine = false;
    CHECK(design_laminate(search, materials, wanted, options).modelled_distance >= design.modelled_distance);
}

TEST_CASE("A judge corrects what the model does not know, and never makes the laminate worse") {
    double before = 0, after = 0;
    for (std::uint64_t trial = 0; trial < 8; ++trial) {
        RandomStream random(80, trial);
        const std::vector<LaminateMaterial> materials = random_materials(random, 3, 2, coefficients);
        const double s = optics::internal_diffuse_reflectance(1.5);
        const LaminateJudge judge = [&](std::span<const LaminateLayer> layers) {
            return other_world(materials, layers, s);
        };
        const std::vector<LaminateLayer> truth{{trial % 3, 0.2}, {(trial + 1) % 3, 0.4}, {(trial + 2) % 3, 0.5}};
        const ChannelProfiles wanted = judge(truth);
        LaminateDesignOptions options;
        options.search = small_search();
        options.turned_back = s;
        const LaminateSearch search(materials, options.search);
        const LaminateDesign design = design_laminate(search, materials, wanted, options, judge);
        REQUIRE(design.judged_distances.size() >= 4);
        CHECK(design.judged_distance ==
              *std::min_element(design.judged_distances.begin(), design.judged_distances.end()));
        CHECK(profile_distance(judge(design.layers), wanted, 1) == Approx(design.judged_distance).margin(1e-12));
        before += design.judged_distances[0];
        after += design.judged_distance;
    }
    CHECK(after < 0.3 * before);
}

TEST_CASE("A target brighter than any laminate is answered with the nearest, and its distance to the gamut") {
    RandomStream random(81, 0);
    const std::vector<LaminateMaterial> materials = random_materials(random, 1, 1, coefficients);  // one material only
    LaminateDesignOptions options;
    options.search = small_search();
    const LaminateDesign design = design_laminate(LaminateSearch(materials, options.search), materials,
                                                  {std::vector<double>(coefficients, 1.0)}, options);
    CHECK(design.outside > 0.1);
    CHECK(design.modelled_distance >= design.outside - 1e-5);
    CHECK(design.layers.size() <= 1);
}

TEST_CASE("Resins are known at a thickness that fits them, and their totals there are exact") {
    const optics::ResinSet set = optics::vero_opaque();
    const optics::Medium white = set.resins[static_cast<std::size_t>(set.find("W"))].medium(1);
    CHECK(fitting_known_mm(white, set.g, 5) == Approx(1.6 / (white.sigma_a + 0.6 * white.sigma_s)));
    CHECK(fitting_known_mm({0, 0}, 0.4, 5) == 2.5);
    CHECK(fitting_known_mm({100, 0}, 0.4, 5) == 0.1);
    CHECK(fitting_known_mm({100, 0}, 0.4, 0.1) == 0.05);

    const optics::HankelGrid grid(5, 8);
    const double known[] = {0.2, 0.3, 0.1};
    const auto W = static_cast<std::size_t>(set.find("W"));
    const LaminateMaterial material = resin_material(set, W, known, grid, {1 << 12, 1});
    REQUIRE(material.size() == 3);
    for (std::size_t c = 0; c < 3; ++c) {
        const optics::DiffuseTotals totals =
            optics::diffuse_totals({{{set.resins[W].medium(c), known[c]}}, set.g, 1, 1});
        CHECK(material[c].of_thickness(known[c]).R_top[0] == Approx(totals.R).margin(1e-9));
        CHECK(material[c].of_thickness(known[c]).T[0] == Approx(totals.T).margin(1e-9));
    }
}

TEST_CASE(
    "Measured profiles of other spacings and lengths become one grid, bad ones are refused by material and channel") {
    const optics::HankelGrid grid(10, 16);
    const auto falling = [](double spacing, std::size_t samples, double total) {
        optics::RadialSamples of;
        of.spacing_mm = spacing;
        for (std::size_t i = 0; i < samples; ++i) of.light.push_back(std::exp(-static_cast<double>(i) * spacing / 0.4));
        of.total = total;
        return of;
    };
    const std::vector<optics::MeasuredProfile> coarse{{0.5, falling(0.05, 100, 0.3), falling(0.05, 100, 0.5)}},
        fine{{0.5, falling(0.02, 300, 0.3), falling(0.025, 200, 0.5)}};
    const MeasuredMaterial a = measured_material("a.json", coarse, grid), b = measured_material("b.json", fine, grid);
    for (std::size_t i = 0; i < grid.size(); ++i)
        CHECK(a.material[0].of_thickness(0.5).R_top[i] ==
              Approx(b.material[0].of_thickness(0.5).R_top[i]).margin(0.01));
    CHECK(a.summary[0].R_total == Approx(0.5));

    std::vector<optics::MeasuredProfile> loud = coarse;
    loud.push_back({0.5, falling(0.05, 100, 0.7), falling(0.05, 100, 0.5)});  // 1.2 of the light
    CHECK_THROWS_WITH(
        (void)measured_material("loud.json", loud, grid),
        Catch::Matchers::Contains("loud.json, channel 2") && Catch::Matchers::Contains("more than it got"));
    std::vector<optics::MeasuredProfile> thin = coarse;
    thin[0].thickness_mm = 0;
    CHECK_THROWS_AS((void)measured_material("thin.json", thin, grid), InputError);
}

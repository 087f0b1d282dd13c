// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/profiles/layered_profile_model.h"
#include "tests/outcomes.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "optics/profiles/bounded_table.h"
#include "tests/optics/transport/slab_scene.h"
#include "tests/same_for_threads.h"

using namespace voxtone::optics;
using namespace voxtone::optics::testing;

namespace {

// A set whose resins absorb nothing.
ResinSet furnace() {
    ResinSet set = vero_opaque();
    for (Resin& resin : set.resins)
        for (double& albedo : resin.albedo) albedo = 1;
    return set;
}

Material material(const ResinSet& set, const char* role) { return static_cast<Material>(set.find(role) + 1); }

}  // namespace

TEST_CASE("The table of bounded layers is what it was made from, and keeps energy") {
    const BoundedTable table(0.4, 1.5, 10);
    for (const double tau : {0.02, 0.3, 1.7, 6.1, 9.5})
        for (const double albedo : {0.05, 0.6, 0.97, 0.9997, 1.0}) {
            INFO(tau << " " << albedo);
            const BoundedTotals exact = bounded_totals({tau * (1 - albedo), tau * albedo}, 0.4, 1.5, 1.0);
            const BoundedTotals at = table.at(tau * (1 - albedo), tau * albedo);
            CHECK(at.R_top == Approx(exact.R_top).margin(1e-3));
            CHECK(at.T_down == Approx(exact.T_down).margin(1e-3));
            CHECK(at.R_bottom == Approx(exact.R_bottom).margin(1e-3));
            CHECK(at.T_up == Approx(exact.T_up).margin(1e-3));
        }
    const BoundedTotals clear = table.at(0, 3);
    CHECK(clear.R_top + clear.T_down == Approx(1).margin(1e-12));
    CHECK(clear.R_bottom + clear.T_up == Approx(1).margin(1e-12));
}

TEST_CASE("Layers that absorb nothing appear white by layer profiles, whatever lies below or behind", "[slow]") {
    const ResinSet set = furnace();
    const LayeredProfileModel model;
    const std::vector<SlabLayer> layers{{material(set, "C"), 3}, {material(set, "Y"), 5}, {material(set, "W"), 40}};
    for (const Backing backing : {Backing::none, Backing::white}) {
        const Appearance seen = slab_appearance(model, set, layers, backing);
        for (const float value : seen.value) CHECK(value == Approx(1).margin(2e-4));
    }
    const Appearance lost = slab_appearance(model, set, layers, Backing::black);
    for (const float value : lost.value) CHECK(value < 0.99);
}

TEST_CASE("Homogeneous slabs and two layers appear as exact solutions say, within the model's error", "[slow]") {
    const ResinSet set = vero_opaque();
    const LayeredProfileModel model;
    const Material W = material(set, "W"), K = material(set, "K"), M = material(set, "M");
    struct Case {
        std::vector<SlabLayer> layers;
        double error;
    };
    // Errors as docs/laminate-search.md has them, rounded up.
    for (const Case& c : {Case{{{W, 74}}, 0.02}, Case{{{K, 74}}, 0.02}, Case{{{M, 12}, {W, 150}}, 0.02},
                          Case{{{W, 12}, {K, 60}}, 0.03}})
        for (const Backing backing : {Backing::none, Backing::black, Backing::white}) {
            const Appearance seen = slab_appearance(model, set, c.layers, backing);
            for (std::size_t channel = 0; channel < 3; ++channel) {
                INFO(c.layers.size() << " layers, material " << int(c.layers[0].material) << ", backing "
                                     << int(backing) << ", channel " << channel);
                CHECK(seen.value[channel] == Approx(exact_appearance(set, c.layers, backing, channel)).margin(c.error));
            }
        }
}

TEST_CASE("Layer profiles see a wall from both sides, and what lies behind it") {
    const ResinSet set = vero_opaque();
    const LayeredProfileModel model({.sideways = false});
    const Material W = material(set, "W"), K = material(set, "K");
    // A wall 0.5 mm thick, its left half white, its right half black; and the same lying down.
    const std::array<double, 3> pitch{0.05, 0.05, 0.05};
    const ResinVolume wall = make_resin_volume({12, 20, 20}, pitch, [&](int x, int, int) {
        return x == 0 || x == 11 ? air : x < 6 ? W : K;
    });
    const ResinVolume slab = make_resin_volume({4, 4, 10}, pitch, [&](int, int, int z) { return z < 5 ? K : W; });
    const Scene scene{&wall, &set, Backing::none, Sides::open}, lying{&slab, &set, Backing::none, Sides::mirrored};
    const Surface surface = find_surface(scene, {1, 1, 1}, SurfacePart::all);
    const Appearance seen = model.predict(scene, surface),
                     expected = model.predict(lying, find_surface(lying, {1, 1, 1}, SurfacePart::top));
    int white = 0, black = 0;
    for (std::size_t i = 0; i < surface.cells.size(); ++i) {
        const SurfaceCell& cell = surface.cells[i];
        if (std::abs(cell.normal[0]) < 0.9999F) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            if (cell.normal[0] < 0) CHECK(seen.value[3 * i + c] == Approx(expected.value[c]).margin(1e-6));
            if (cell.normal[0] > 0) CHECK(seen.value[3 * i + c] < expected.value[c]);
        }
        (cell.normal[0] < 0 ? white : black) += 1;
    }
    CHECK(white > 100);
    CHECK(black > 100);
}

TEST_CASE("Layer profiles answer the same for any number of threads, and refuse materials without a resin", "[slow]") {
    const ResinSet set = vero_opaque();
    const LayeredProfileModel model;
    const ResinVolume volume = make_resin_volume({40, 20, 30}, slab_pitch_mm, [](int x, int y, int z) {
        return static_cast<Material>(1 + (x / 3 + y + z / 2) % 5);
    });
    const Scene scene{&volume, &set, Backing::white, Sides::open};
    const Surface surface = find_surface(scene, {2, 1, 3}, SurfacePart::all);
    for (const float value : voxtone::test::same_for_threads([&] { return model.predict(scene, surface).value; }))
        CHECK((value >= 0 && value <= 1));

    const ResinVolume strange = make_resin_volume({4, 4, 4}, slab_pitch_mm, [](int, int, int) { return Material{9}; });
    const Scene unknown{&strange, &set, Backing::none, Sides::open};
    CHECK_THROWS_AS((void)model.predict(unknown, find_surface(unknown, {2, 1, 3}, SurfacePart::all)),
                    voxtone::InputError);
}

TEST_CASE(
    "A slab that is the same everywhere shows by layer profiles what its layers alone show, whatever goes sideways",
    "[slow]") {
    const ResinSet set = vero_opaque();
    const Material W = material(set, "W"), M = material(set, "M");
    for (const Backing backing : {Backing::none, Backing::black, Backing::white}) {
        const std::vector<SlabLayer> layers{{M, 6}, {W, 40}};
        const ResinVolume volume = slab_volume(layers, 80, 40);
        const Scene scene{&volume, &set, backing, Sides::mirrored};
        const Surface surface = find_surface(scene, {4, 2, 6}, SurfacePart::top);
        const std::vector<float> own = LayeredProfileModel({.sideways = false}).predict(scene, surface).value,
                                 with = LayeredProfileModel().predict(scene, surface).value;
        REQUIRE(own.size() == 3 * 400);
        for (std::size_t i = 0; i < own.size(); ++i) CHECK(with[i] == Approx(own[i]).epsilon(2e-5));
    }
}

TEST_CASE(
    "Where bodies meet that absorb nothing layer profiles miss light, as docs/laminate-search.md says, and never add "
    "any") {
    const ResinSet set = furnace();
    const Material W = material(set, "W"), M = material(set, "M");
    const ResinVolume volume =
        make_resin_volume({96, 4, 74}, slab_pitch_mm, [&](int x, int, int) { return x < 48 ? W : M; });
    const Scene scene{&volume, &set, Backing::white, Sides::mirrored};
    const std::vector<float> seen =
        LayeredProfileModel().predict(scene, find_surface(scene, {4, 2, 6}, SurfacePart::top)).value;
    const auto [least, most] = std::minmax_element(seen.begin(), seen.end());
    WANTED(*least > 0.99);
    CHECK(*least > 0.855);
    CHECK(*most <= 1);
}

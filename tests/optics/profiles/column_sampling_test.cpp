// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/profiles/column_sampling.h"

#include <catch2/catch.hpp>

#include "tests/optics/transport/slab_scene.h"

using namespace voxtone::optics;
using namespace voxtone::optics::testing;

TEST_CASE("Under a cell lie the layers of the volume, as shares and in order, up to the other side") {
    const ResinSet set = vero_opaque();
    // Left half: 4 voxels of material 1 on 6 of material 2; right half: 10 of material 2.
    const ResinVolume volume = make_resin_volume({4, 2, 10}, {0.05, 0.05, 0.05}, [](int x, int, int z) {
        return static_cast<Material>(x < 2 && z >= 6 ? 1 : 2);
    });
    for (const Backing backing : {Backing::none, Backing::black, Backing::white}) {
        const Scene scene{&volume, &set, backing, Sides::mirrored};
        const Surface surface = find_surface(scene, {4, 2, 1}, SurfacePart::top);
        REQUIRE(surface.cells.size() == 1);
        MaterialColumn layers;
        ColumnSampler(scene).under(surface, surface.cells[0], layers);
        REQUIRE(layers.steps.size() == 10);
        CHECK(layers.mm == Approx(0.5));
        CHECK(layers.end == (backing == Backing::none    ? LayersEnd::open
                             : backing == Backing::black ? LayersEnd::black_sheet
                                                         : LayersEnd::white_sheet));
        for (std::size_t i = 0; i < 10; ++i) {
            const MaterialColumn::Step& step = layers.steps[i];
            CHECK(step.mm == Approx(0.05));
            CHECK(layers.shares[step.first + 1] == (i < 4 ? 0.5F : 0));
            CHECK(layers.shares[step.first + 2] == (i < 4 ? 0.5F : 1));
        }
    }
}

TEST_CASE("Deep bodies are endless, and their steps grow with the depth") {
    const ResinSet set = vero_opaque();
    const ResinVolume volume =
        make_resin_volume({2, 2, 400}, {0.05, 0.05, 0.05}, [](int, int, int) { return Material{1}; });
    const Scene scene{&volume, &set, Backing::black, Sides::mirrored};
    const Surface surface = find_surface(scene, {2, 2, 1}, SurfacePart::top);
    MaterialColumn layers;
    ColumnSampler(scene).under(surface, surface.cells[0], layers);
    CHECK(layers.end == LayersEnd::endless);
    CHECK(layers.mm >= 15);
    CHECK(layers.mm < 16);
    CHECK(layers.steps.size() < 100);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/grid/block_contrast.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include "optics/grid/homogenisation.h"
#include "optics/grid/viewing_grid_builder.h"
#include "optics/scene/appearance_model.h"

using namespace voxtone;
using namespace voxtone::optics;

namespace {

constexpr std::array<double, 3> j750{0.0423333, 0.0846667, 0.027};
constexpr std::array<int, 3> viewing_cell{2, 1, 3};

/// Blocks of 8 x 4 x 12 voxels, from the top.
template <class MaterialOf>
struct FilledSlab {
    explicit FilledSlab(MaterialOf&& material_of) : volume(make_resin_volume({64, 32, 48}, j750, material_of)) {
        const Scene scene{&volume, &set, Backing::black, Sides::mirrored};
        const BlockLattice lattice(volume.size(), viewing_cell);
        grid = make_viewing_grid(scene, viewing_cell, {0.8}, {}, {{}, lattice.blocks, {}});
        std::vector<std::uint8_t> wanted;
        REQUIRE(homogenise(grid, volume, wanted));
    }
    /// Of the block at a voxel of the uppermost blocks.
    [[nodiscard]] float contrast_at(int x, int y) const {
        const std::vector<float> contrast = contrast_of_blocks(grid, set);
        for (std::size_t t = 0; t < contrast.size(); ++t) {
            const auto corner = grid.corner_of(grid.transport_block(t).at);
            if (corner[0] <= x && x < corner[0] + 8 && corner[1] <= y && y < corner[1] + 4 && corner[2] + 12 >= 48)
                return contrast[t];
        }
        return -1;
    }
    [[nodiscard]] std::size_t chosen(double least) const {
        return blocks_of_contrast(grid, set, blocks_to_refine(grid, volume, Refinement::contrast), least).size();
    }
    ResinSet set = vero_opaque();
    ResinVolume volume;
    ViewingGrid grid;
};

double rms_difference(const ResinSet& set, Material a, Material b) {
    const std::vector<float> lightness = lightness_of_resins(set);
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c)
        sum += std::pow(double(lightness[(a - 1u) * 3 + c] - lightness[(b - 1u) * 3 + c]), 2) / 3;
    return std::sqrt(sum);
}

}  // namespace

TEST_CASE("Resins are as light as thick bodies of them") {
    ResinSet set = vero_opaque();
    for (Resin& resin : set.resins) resin.albedo.assign(3, 1.0);
    for (const float l : lightness_of_resins(set)) CHECK(l == Approx(100));
    for (Resin& resin : set.resins) resin.albedo.assign(3, 0.0);
    for (const float l : lightness_of_resins(set)) CHECK(l == 0);
    // Isotropic scattering, albedo 0.9: van de Hulst's formula by hand, s = 0.31623, A = 0.47717.
    set.g = 0;
    for (Resin& resin : set.resins) resin.albedo.assign(3, 0.9);
    for (const float l : lightness_of_resins(set)) CHECK(l == Approx(116 * std::cbrt(0.47717) - 16).epsilon(1e-4));
}

TEST_CASE("The contrast of a block is the spread of its resins, or what sets it apart from a neighbour") {
    const FilledSlab slab([](int x, int y, int z) {
        if (x >= 32) return 4;                          // black
        return y < 16 && (x + y + z) % 2 == 0 ? 1 : 5;  // cyan on white for a half, white beyond
    });
    const double cyan = rms_difference(slab.set, 1, 5), black = rms_difference(slab.set, 4, 5);
    REQUIRE(cyan > 10);
    REQUIRE(black > 60);
    CHECK(slab.contrast_at(4, 4) == Approx(0.5 * cyan).epsilon(1e-3));
    CHECK(slab.contrast_at(4, 28) == Approx(0).margin(0.05));
    CHECK(slab.contrast_at(28, 28) == Approx(0.5 * black).epsilon(1e-3));
    CHECK(slab.contrast_at(36, 28) == Approx(0.5 * black).epsilon(1e-3));
    CHECK(slab.contrast_at(60, 28) == Approx(0).margin(0.05));
}

TEST_CASE("The more contrast is asked for, the fewer blocks are cut, a body of one resin is not cut at all") {
    const FilledSlab slab([](int x, int y, int z) {
        if (y < 16) return (x + 3 * y + 7 * z) % 60 == 0 ? 3 : 5;  // some yellow
        return (x + y + z) % 8 == 0 ? 4 : 5;                       // more black
    });
    // 8 x 8 blocks of 8 x 4 voxels on top, half of them without black. Standard deviations of two resins of which one
    // has the share p are sqrt(p (1 - p)) times their difference: black's lie above 8, yellow's below.
    const double yellow = rms_difference(slab.set, 3, 5) * std::sqrt(59.0) / 60,
                 black = rms_difference(slab.set, 4, 5) * std::sqrt(7.0) / 8;
    REQUIRE(yellow < 7);
    REQUIRE(black > 9);
    CHECK(slab.chosen(0) == 64);
    // Besides those of black the ones beside it, whose mean is as far off.
    const double beside = 0.5 * rms_difference(slab.set, 4, 5) / 8;
    CHECK(slab.chosen(8) == (beside > 8 ? 40u : 32u));
    CHECK(slab.chosen(60) == 0);
    const FilledSlab white([](int, int, int) { return 5; });
    CHECK(blocks_to_refine(white.grid, white.volume, Refinement::contrast).empty());
    CHECK_FALSE(blocks_to_refine(white.grid, white.volume, Refinement::all).empty());
}

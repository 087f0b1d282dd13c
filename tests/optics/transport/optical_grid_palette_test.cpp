// SPDX-License-Identifier: GPL-3.0-or-later
//
// Mixtures of cells and blocks are numbered: a body with more of them than a palette takes still has the right, or the
// nearest, mixture everywhere.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <map>

#include "voxtone/base/random.h"
#include "voxtone/optics/transport/optical_grid.h"

using namespace voxtone::optics;

namespace {

using Place = std::array<int, 3>;
constexpr std::array<double, 3> pitch{0.04, 0.04, 0.04};

/// Shares of the resins in a box of voxels, all of them solid.
std::map<Material, float> shares_in(const ResinVolume& volume, const Place& corner, const Place& extent) {
    const int voxels = extent[0] * extent[1] * extent[2];
    std::vector<Material> box(static_cast<std::size_t>(voxels));
    volume.copy_box(corner, extent, box);
    std::map<Material, float> shares;
    for (const Material m : box) shares[m] += 1;
    for (auto& [m, share] : shares) share /= static_cast<float>(voxels);
    return shares;
}

float distance(const std::map<Material, float>& shares, const PaletteEntry& entry) {
    std::map<Material, float> rest = shares;
    for (const auto& [m, share] : entry.shares) rest[m] -= share;
    float sum = 0;
    for (const auto& [m, share] : rest) sum += std::abs(share);
    return sum;
}

float nearest(const std::map<Material, float>& shares, const std::vector<PaletteEntry>& palette) {
    float least = 2;
    for (std::size_t m = 1; m < palette.size(); ++m) least = std::min(least, distance(shares, palette[m]));
    return least;
}

}  // namespace

TEST_CASE("In a full palette of cells a mixture is taken for the nearest there is") {
    const ResinSet set = vero_opaque();
    const ResinVolume volume = make_resin_volume({32, 24, 32}, pitch, [](int x, int y, int z) {
        return 1 +
               static_cast<int>(voxtone::philox4x32({std::uint32_t((z * 32 + y) * 32 + x), 0, 0, 0}, {1, 0})[0] % 5);
    });
    const Scene scene{&volume, &set, Backing::none, Sides::open};
    GridOptions options;
    options.view_voxels = options.skin_voxels = {2, 2, 2};
    const OpticalGrid roomy(scene, options);
    options.most_mixtures = 24;
    const OpticalGrid full(scene, options);
    REQUIRE(roomy.palette.size() > 100);
    REQUIRE(full.palette.size() == 24);
    int merged = 0;
    for (int z = 0; z < 32; z += 2)
        for (int y = 0; y < 24; y += 2)
            for (int x = 0; x < 32; x += 2) {
                const auto shares = shares_in(volume, {x, y, z}, {2, 2, 2});
                const std::int64_t there = roomy.cell_at({x, y, z}), here = full.cell_at({x, y, z});
                REQUIRE((there >= 0 && here >= 0));
                const PaletteEntry& exact = roomy.palette[roomy.medium[std::size_t(there)]];
                const PaletteEntry& taken = full.palette[full.medium[std::size_t(here)]];
                REQUIRE(distance(shares, exact) < 1e-5f);
                REQUIRE(distance(shares, taken) < nearest(shares, full.palette) + 1e-5f);
                merged += distance(shares, taken) > 0.1f;
            }
    CHECK(merged > 100);
}

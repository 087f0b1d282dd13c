// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/layer_volume.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

constexpr int width = 45, height = 38, depth = 40;
constexpr std::array<double, 3> pitch_mm{0.04, 0.08, 0.03};

/// Any material at any place, in runs.
io::Material material_at(int x, int y, int z) {
    RandomStream random(9, std::uint64_t((z * height + y) * width + x) / 3);
    return io::Material(random.bits() % 5);
}

io::LayerRuns layer_at(int z) {
    io::LayerRuns layer(width, height);
    for (int row = 0; row < height; ++row) {  // the top row is the largest y
        for (int x = 0; x < width; ++x) layer.push(1, material_at(x, height - 1 - row, z));
        layer.end_row();
    }
    return layer;
}

std::size_t wrong_voxels(const optics::ResinVolume& volume, const LayerWindow& window,
                         const std::array<optics::Material, io::max_materials>& materials) {
    std::size_t wrong = 0;
    for (int z = 0; z < window.size[2]; ++z)
        for (int y = 0; y < window.size[1]; ++y)
            for (int x = 0; x < window.size[0]; ++x)
                wrong += volume.at(x, y, z) !=
                         materials[material_at(window.corner[0] + x, window.corner[1] + y, window.corner[2] + z)];
    return wrong;
}

}  // namespace

TEST_CASE("A volume holds its layers' voxels, from a window of them, in any order and from any thread") {
    std::array<optics::Material, io::max_materials> swapped{};
    for (std::size_t m = 0; m < swapped.size(); ++m) swapped[m] = optics::Material(m == 0 ? 0 : 6 - m % 6);
    for (const LayerWindow& window :
         {LayerWindow{{0, 0, 0}, {width, height, depth}}, LayerWindow{{7, 5, 3}, {20, 17, 33}},
          LayerWindow{{width - 1, height - 1, depth - 1}, {1, 1, 1}}, LayerWindow{{0, 21, 8}, {45, 16, 16}}})
        for (const auto& materials : {LayerVolume::same_materials(), swapped}) {
            CAPTURE(window.corner, window.size);
            LayerVolume made(window, pitch_mm, materials, std::numeric_limits<std::uint64_t>::max());
            // Layers that are not in the window are there too, and are ignored.
            std::vector<int> order(depth);
            std::iota(order.begin(), order.end(), 0);
            for (std::size_t n = 0; n < order.size(); ++n) std::swap(order[n], order[(7 * n + 11) % order.size()]);
            parallel_for(0, order.size(), 1, [&](std::size_t n) { made.add(order[n], layer_at(order[n])); });
            const optics::ResinVolume volume = made.finish();
            CHECK(volume.size() == window.size);
            CHECK(volume.pitch_mm() == pitch_mm);
            CHECK(wrong_voxels(volume, window, materials) == 0);
        }
}

TEST_CASE("A volume that needs more memory than it may have says how much that would be") {
    const LayerWindow window{{0, 0, 0}, {width, height, depth}};
    LayerVolume whole(window, pitch_mm, LayerVolume::same_materials(), std::numeric_limits<std::uint64_t>::max());
    for (int k = 0; k < depth; ++k) whole.add(k, layer_at(k));
    const std::uint64_t needed = whole.finish().memory_bytes();

    const auto add_all = [&](std::uint64_t allowed) {
        LayerVolume made(window, pitch_mm, LayerVolume::same_materials(), allowed);
        for (int k = 0; k < depth; ++k) made.add(k, layer_at(k));
        return made.finish().memory_bytes();
    };
    CHECK(add_all(needed + 4096) == needed);
    CHECK_THROWS_AS(add_all(needed / 4), ResourceError);
    CHECK_THROWS_WITH(add_all(needed / 4), Catch::Contains("45 x 38 x 40") && Catch::Contains("--memory"));
}

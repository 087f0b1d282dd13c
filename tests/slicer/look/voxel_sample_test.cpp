// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/voxel_sample.h"

#include <utility>

#include <catch2/catch.hpp>

#include "base/parallel.h"
#include "io/files/deflate.h"
#include "io/report/viewer_data.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

/// No two neighbours alike, and nothing on one side.
io::Material material_at(std::uint32_t x, std::uint32_t row, int k) {
    return x < 3 ? io::background : io::Material(1 + (3 * x + 5 * row + 7 * std::uint32_t(k)) % 5);
}

io::LayerRuns layer_of(const VoxelGrid& grid, int k) {
    io::LayerRuns layer{std::uint32_t(grid.size[0]), std::uint32_t(grid.size[1])};
    for (std::uint32_t row = 0; row < layer.height_px(); ++row) {
        for (std::uint32_t x = 0; x < layer.width_px(); ++x) layer.push(1, material_at(x, row, k));
        layer.end_row();
    }
    return layer;
}

int material_in(const io::ViewerLayer& layer, std::uint32_t columns, std::uint32_t rows, std::uint32_t x,
                std::uint32_t row) {
    const std::uint32_t row_bytes = (columns + 1) / 2;
    const auto bytes = io::inflated(layer.deflated, std::size_t{row_bytes} * rows);
    return std::to_integer<int>(bytes[row * row_bytes + x / 2] >> (x % 2 ? 4 : 0)) & 15;
}

io::ViewerVoxels sampled(const VoxelGrid& grid, double most, std::size_t bytes, int first = 0) {
    VoxelSample sample(first, grid.size[2] - first, grid, most);
    parallel_for(std::size_t(first), std::size_t(grid.size[2]), 1,
                 [&](std::size_t k) { sample.offer(int(k), layer_of(grid, int(k))); });
    return sample.take(bytes);
}

/// Every voxel that is carried is the one that it stands for.
void check_voxels(const io::ViewerVoxels& v, int first) {
    const std::uint32_t columns = (v.size[0] + v.step[0] - 1) / v.step[0],
                        rows = (v.size[1] + v.step[1] - 1) / v.step[1];
    REQUIRE(v.layers.size() == (v.size[2] - std::uint32_t(first) + v.step[2] - 1) / v.step[2]);
    for (std::size_t i = 0; i < v.layers.size(); ++i) {
        REQUIRE(v.layers[i].number == std::uint32_t(first) + i * v.step[2]);
        for (std::uint32_t row = 0; row < rows; ++row)
            for (std::uint32_t x = 0; x < columns; ++x)
                REQUIRE(material_in(v.layers[i], columns, rows, x, row) ==
                        material_at(x * v.step[0], row * v.step[1], int(v.layers[i].number)));
    }
    for (const io::ViewerLayer& layer : v.whole)
        for (std::uint32_t row = 0; row < v.size[1]; ++row)
            for (std::uint32_t x = 0; x < v.size[0]; ++x)
                REQUIRE(material_in(layer, v.size[0], v.size[1], x, row) == material_at(x, row, int(layer.number)));
}

const VoxelGrid grid{{0, 0, 0}, {0.042, 0.085, 0.027}, {23, 14, 31}};

}  // namespace

TEST_CASE("A small print's voxels are carried all, a larger one's one of two where they are closest") {
    const io::ViewerVoxels all = sampled(grid, 1e9, 1 << 20);
    CHECK(all.step == std::array<std::uint32_t, 3>{1, 1, 1});
    CHECK(all.whole.empty());
    check_voxels(all, 0);

    const double voxels = 23 * 14 * 31;
    const io::ViewerVoxels up = sampled(grid, 0.6 * voxels, 1 << 20);
    CHECK(up.step == std::array<std::uint32_t, 3>{1, 1, 2});
    check_voxels(up, 0);
    const io::ViewerVoxels two = sampled(grid, 0.3 * voxels, 1 << 20, 5);
    CHECK(two.step == std::array<std::uint32_t, 3>{2, 1, 2});
    CHECK(two.whole.size() >= 20);
    CHECK(two.whole.back().number == 30);
    check_voxels(two, 5);
    // All of two before one of three.
    CHECK(sampled(grid, 0.15 * voxels, 1 << 20).step == std::array<std::uint32_t, 3>{2, 2, 2});
}

TEST_CASE("Voxels that take more room than the page has are thinned until they fit") {
    const io::ViewerVoxels all = sampled(grid, 1e9, 1 << 20);
    const std::size_t bytes = io::packed_bytes(all) / 5;
    const io::ViewerVoxels fewer = sampled(grid, 1e9, bytes);
    CHECK(io::packed_bytes(fewer) <= bytes);
    CHECK(fewer.layers.size() < all.layers.size());
    check_voxels(fewer, 0);
}

TEST_CASE("Voxels of a volume are those of its layers, for any number of threads") {
    const auto volume = optics::make_resin_volume(grid.size, {0.042, 0.085, 0.027}, [](int x, int y, int z) {
        return material_at(std::uint32_t(x), std::uint32_t(13 - y), z);
    });
    const io::ViewerVoxels from_layers = sampled(grid, 1e9, 1 << 20);
    for (const std::size_t threads : {1u, 4u}) {
        const ThreadLimit limit(threads);
        const io::ViewerVoxels from_volume = voxels_of(volume, 1 << 20);
        check_voxels(from_volume, 0);
        REQUIRE(from_volume.layers.size() == from_layers.layers.size());
        for (std::size_t i = 0; i < from_layers.layers.size(); ++i)
            CHECK(from_volume.layers[i].deflated == from_layers.layers[i].deflated);
    }
}

TEST_CASE("Samples of parts of the layers, put together, are the sample of all") {
    const double most = 0.3 * 23 * 14 * 31;
    const io::ViewerVoxels whole = sampled(grid, most, 1 << 20);
    VoxelSample together(0, grid.size[2], grid, most);
    for (const auto& [first, end] : {std::pair{20, 31}, {0, 7}, {7, 20}}) {
        VoxelSample part(0, grid.size[2], grid, most);
        for (int k = first; k < end; ++k) part.offer(k, layer_of(grid, k));
        together.put(part.take_layers());
        CHECK(part.take_layers().thinned.empty());
    }
    const io::ViewerVoxels all = together.take(1 << 20);
    check_voxels(all, 0);
    REQUIRE(all.whole.size() == whole.whole.size());
    REQUIRE(all.layers.size() == whole.layers.size());
    for (std::size_t i = 0; i < all.layers.size(); ++i) CHECK(all.layers[i].deflated == whole.layers[i].deflated);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "optics/scene/appearance_model.h"

using namespace voxtone::optics;

namespace {

constexpr std::array<double, 3> j750{0.0423333, 0.0846667, 0.027};

int pattern(int x, int y, int z) { return (x * 7 + y * 13 + z * 29) % 11 < 5 ? 0 : 1 + (x / 20 + y / 17 + z / 19) % 3; }

}  // namespace

TEST_CASE("A volume gives back every voxel, by one, by box and by count") {
    const std::array<int, 3> size{37, 18, 41};
    const ResinVolume volume = make_resin_volume(size, j750, pattern);
    std::vector<Material> box(static_cast<std::size_t>(20 * 25 * 50));
    volume.copy_box({-3, -2, -4}, {20, 25, 50}, box);
    std::size_t i = 0, wrong = 0;
    std::uint64_t ones = 0;
    for (int z = -4; z < 46; ++z)
        for (int y = -2; y < 23; ++y)
            for (int x = -3; x < 17; ++x, ++i) {
                const bool inside = x >= 0 && y >= 0 && z >= 0 && x < size[0] && y < size[1] && z < size[2];
                const int expected = inside ? pattern(x, y, z) : 0;
                wrong += box[i] != expected || volume.at(x, y, z) != expected;
            }
    CHECK(wrong == 0);
    for (int z = 0; z < size[2]; ++z)
        for (int y = 0; y < size[1]; ++y)
            for (int x = 0; x < size[0]; ++x) ones += pattern(x, y, z) == 1;
    CHECK(volume.count()[1] == ones);
}

TEST_CASE("A volume is the same whether built of layers, of rows of blocks or of parts that are stacked") {
    const std::array<int, 3> size{37, 50, 41};
    const ResinVolume layers = make_resin_volume(size, j750, pattern);
    std::vector<ResinVolume> parts;
    for (int z0 = 0; z0 < size[2]; z0 += ResinVolume::block_edge) {
        const int depth = std::min(ResinVolume::block_edge, size[2] - z0);
        ResinVolumeBuilder builder({size[0], size[1], depth}, j750);
        for (int y0 = 0; y0 < size[1]; y0 += ResinVolume::block_edge) {
            std::vector<Material> rows;
            for (int z = z0; z < z0 + depth; ++z)
                for (int y = y0; y < std::min(y0 + ResinVolume::block_edge, size[1]); ++y)
                    for (int x = 0; x < size[0]; ++x) rows.push_back(static_cast<Material>(pattern(x, y, z)));
            builder.add_block_row(rows);
        }
        parts.push_back(builder.finish());
    }
    const ResinVolume whole = stacked(std::move(parts));
    CHECK(whole.size() == size);
    CHECK(whole.memory_bytes() == layers.memory_bytes());
    std::size_t wrong = 0;
    for (int z = 0; z < size[2]; ++z)
        for (int y = 0; y < size[1]; ++y)
            for (int x = 0; x < size[0]; ++x) wrong += whole.at(x, y, z) != layers.at(x, y, z);
    CHECK(wrong == 0);
}

TEST_CASE("The white twin is solid where the volume is, and of one resin") {
    const std::array<int, 3> size{37, 50, 41};
    // Solid with a hole; many resins.
    const auto made = [](int x, int y, int z) { return x > 5 && x < 9 && y > 20 ? 0 : 1 + (x + y + z) % 4; };
    const ResinVolume volume = make_resin_volume(size, j750, made);
    const ResinVolume twin = all_of(volume, 7);
    std::size_t wrong = 0;
    for (int z = 0; z < size[2]; ++z)
        for (int y = 0; y < size[1]; ++y)
            for (int x = 0; x < size[0]; ++x) wrong += twin.at(x, y, z) != (made(x, y, z) == 0 ? 0 : 7);
    CHECK(wrong == 0);
    CHECK(twin.count()[7] + twin.count()[0] == static_cast<std::uint64_t>(37 * 50 * 41));
    // Blocks along x = 16 and beyond are whole, also those that the border cuts: 576 bytes for each of the others.
    CHECK(twin.uniform_material({16, 0, 0}, {21, 50, 41}) == 7);
    CHECK(twin.memory_bytes() < volume.memory_bytes() / 2);
}

TEST_CASE("Blocks that are made anew are, and nothing else is") {
    const std::array<int, 3> size{37, 50, 41};
    const auto made = [](int x, int y, int z) { return y < 18 || (x > 5 && x < 9) ? 0 : 1 + (x + y + z) % 4; };
    const ResinVolume volume = make_resin_volume(size, j750, made);
    /// Of a mixed block, of one that was all solid, of one that was air; what it gets is what `all_of` has there.
    class Painter final : public BlockRemake {
    public:
        [[nodiscard]] bool touches(const std::array<int, 3>& block) const override {
            return block == std::array{0, 1, 1} || block == std::array{2, 3, 2} || block == std::array{1, 0, 0};
        }
        void remake(const std::array<int, 3>& block, std::span<Material> voxels) const override {
            for (std::size_t i = 0; i < voxels.size(); ++i)
                if (voxels[i] != air && i % 3 == 0) voxels[i] = static_cast<Material>(8 + block[0] + i % 2);
            if (block[1] == 0) voxels[5] = 9;
        }
    };
    const Painter painter;
    const ResinVolume print = remade(volume, 7, &painter);
    std::size_t wrong = 0;
    for (int z = 0; z < size[2]; ++z)
        for (int y = 0; y < size[1]; ++y)
            for (int x = 0; x < size[0]; ++x) {
                const std::array<int, 3> block{x / 16, y / 16, z / 16};
                const int i = (z % 16 * 16 + y % 16) * 16 + x % 16;
                int expected = made(x, y, z) == 0 ? 0 : 7;
                if (painter.touches(block)) {
                    if (expected == 7 && i % 3 == 0) expected = 8 + block[0] + i % 2;
                    if (block[1] == 0 && i == 5) expected = 9;
                }
                wrong += print.at(x, y, z) != expected;
            }
    CHECK(wrong == 0);
    CHECK(print.at(21, 0, 0) == 9);
    CHECK(print.count()[10] > 0);
}

TEST_CASE("Boxes of one material are known as such") {
    const ResinVolume volume = make_resin_volume({64, 64, 64}, j750, [](int x, int, int) { return x < 40 ? 2 : 3; });
    CHECK(volume.uniform_material({0, 0, 0}, {40, 64, 64}) == 2);
    CHECK(volume.uniform_material({0, 0, 0}, {41, 64, 64}) == -1);
    CHECK(volume.uniform_material({40, 1, 1}, {24, 3, 3}) == 3);
    CHECK(volume.uniform_material({60, 1, 1}, {5, 3, 3}) == -1);
    CHECK(volume.uniform_material({70, 1, 1}, {5, 3, 3}) == air);
    CHECK(volume.memory_bytes() < 64 * 64 * 64 / 2);
}

TEST_CASE("The surface of a box is its six sides, sharp at the edges, and the lower side is dark on a sheet") {
    const ResinVolume volume = make_resin_volume({40, 24, 60}, j750, [](int, int, int) { return 1; });
    Scene scene{&volume, nullptr, Backing::none, Sides::open};
    Surface surface = find_surface(scene, {2, 1, 3}, SurfacePart::all);
    CHECK(surface.faces.size() == 2 * (40 * 24 + 40 * 60 + 24 * 60));
    double area = 0;
    for (const auto& cell : surface.cells) area += cell.area_mm2;
    const double a = 40 * j750[0], b = 24 * j750[1], c = 60 * j750[2];
    CHECK(area == Approx(2 * (a * b + b * c + a * c)).epsilon(1e-5));
    for (const SurfaceFace& face : surface.faces) REQUIRE_FALSE(face.slants);
    scene.backing = Backing::black;
    CHECK(find_surface(scene, {2, 1, 3}, SurfacePart::all).faces.size() == 2 * (40 * 60 + 24 * 60) + 40 * 24);
    const Surface top = find_surface(scene, {2, 1, 3}, SurfacePart::top);
    CHECK(top.cells.size() == 20 * 24);
    CHECK(top.cells[1].cell == std::array<std::int32_t, 3>{1, 0, 19});
    CHECK(top.cells[0].centre_mm[2] == Approx(60 * j750[2]));
}

TEST_CASE("Mirrored sides have no surface") {
    const ResinVolume volume = make_resin_volume({10, 8, 30}, j750, [](int, int, int) { return 1; });
    const Scene scene{&volume, nullptr, Backing::black, Sides::mirrored};
    const Surface surface = find_surface(scene, {2, 1, 3}, SurfacePart::all);
    CHECK(surface.faces.size() == 80);
    for (const SurfaceCell& cell : surface.cells)
        for (std::size_t f = cell.first_face; f < cell.first_face + cell.faces; ++f)
            REQUIRE(surface.normal_at(0, f)[2] == 1.0f);
}

TEST_CASE("A sphere of voxels has the area and the normals of a sphere") {
    const double r = 2.5, centre = 3;
    const auto steps = [&](std::size_t a) { return static_cast<int>(std::ceil(2 * centre / j750[a])); };
    const ResinVolume volume = make_resin_volume({steps(0), steps(1), steps(2)}, j750, [&](int x, int y, int z) {
        return std::hypot((x + 0.5) * j750[0] - centre, (y + 0.5) * j750[1] - centre, (z + 0.5) * j750[2] - centre) < r;
    });
    const Surface surface = find_surface({&volume, nullptr, Backing::none, Sides::open}, {2, 1, 3}, SurfacePart::all);
    double area = 0, turned = 0;
    for (const auto& cell : surface.cells) {
        area += cell.area_mm2;
        std::array<double, 3> radial{};
        for (std::size_t k = 0; k < 3; ++k) radial[k] = cell.centre_mm[k] - centre;
        const double length = std::hypot(radial[0], radial[1], radial[2]);
        turned +=
            cell.area_mm2 *
            std::acos(std::min(
                1.0, (radial[0] * cell.normal[0] + radial[1] * cell.normal[1] + radial[2] * cell.normal[2]) / length));
    }
    CHECK(area == Approx(4 * M_PI * r * r).epsilon(0.02));
    CHECK(turned / area < 3.5 * M_PI / 180);
}

TEST_CASE("Blocks of any number of materials give back their voxels, and take as many bits a voxel as they need") {
    const std::array<int, 3> size{64, 16, 16};  // four blocks
    const auto bytes_with = [&](int materials) {
        const auto material = [&](int x, int y, int z) { return 3 + (x * 7 + y * 5 + z * 3) % materials; };
        const ResinVolume volume = make_resin_volume(size, j750, material);
        std::vector<Material> box(64 * 16 * 16);
        volume.copy_box({0, 0, 0}, size, box);
        std::size_t i = 0, wrong = 0;
        for (int z = 0; z < 16; ++z)
            for (int y = 0; y < 16; ++y)
                for (int x = 0; x < 64; ++x, ++i)
                    wrong += box[i] != material(x, y, z) || volume.at(x, y, z) != material(x, y, z);
        CHECK(wrong == 0);
        return volume.memory_bytes() / 4;
    };
    constexpr std::size_t voxels = 16 * 16 * 16, head = 64, place = 4;
    CHECK(bytes_with(1) == place);
    CHECK(bytes_with(2) == place + head + voxels / 8);
    for (const int materials : {3, 4}) CHECK(bytes_with(materials) == place + head + voxels / 4);
    for (const int materials : {5, 16}) CHECK(bytes_with(materials) == place + head + voxels / 2);
    for (const int materials : {17, 250}) CHECK(bytes_with(materials) == place + head + voxels);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/media/mirrored_box.h"

#include <catch2/catch.hpp>

using namespace voxtone::optics;

TEST_CASE("An index beyond two mirrors is seen where its image is", "[volume]") {
    const std::vector<int> seen{0, 0, 1, 2, 2, 1, 0, 0, 1, 2, 2, 1, 0, 0};
    for (int i = 0; i < static_cast<int>(seen.size()); ++i) CHECK(reflected(i - 7, 3) == seen[std::size_t(i)]);
    for (const int i : {-7, -1, 0, 1, 9}) CHECK(reflected(i, 1) == 0);
}

TEST_CASE("A box of a volume with mirrors at its sides goes on as the volume's image, above and below as air",
          "[volume]") {
    constexpr int nx = 3, ny = 2, nz = 2;
    const auto at = [](int x, int y, int z) { return static_cast<Material>(1 + (z * ny + y) * nx + x); };
    const ResinVolume volume = make_resin_volume({nx, ny, nz}, {0.1, 0.1, 0.1}, at);
    std::vector<Material> box;
    for (const std::array<int, 3> corner : {std::array{0, 0, 0}, {-2, 0, 0}, {0, -2, 0}, {1, 1, 1}, {-3, -3, -1}})
        for (const bool mirrored : {false, true}) {
            const std::array<int, 3> extent{5, 4, 3};
            read_box(volume, mirrored, corner, extent, box);
            REQUIRE(box.size() == 60);
            std::size_t i = 0;
            bool right = true;
            for (int z = corner[2]; z < corner[2] + extent[2]; ++z)
                for (int y = corner[1]; y < corner[1] + extent[1]; ++y)
                    for (int x = corner[0]; x < corner[0] + extent[0]; ++x) {
                        const bool inside = x >= 0 && x < nx && y >= 0 && y < ny;
                        const bool there = z >= 0 && z < nz && (inside || mirrored);
                        const Material wanted = there ? at(reflected(x, nx), reflected(y, ny), z) : Material{};
                        right = right && box[i++] == wanted;
                    }
            CHECK(right);
        }
}

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bodies for which memory does not suffice: predicted in tiles.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "optics/transport/transport.h"

using namespace voxtone::optics;

namespace {

constexpr std::array<double, 3> j750{0.0423333, 0.0846667, 0.027};

/// An ellipsoid of white with a halftone of inks in its outer 0.4 mm, and a hole bored along x. Radii in mm.
ResinVolume halftoned_body(const std::array<double, 3>& radii) {
    std::array<int, 3> size{};
    for (std::size_t a = 0; a < 3; ++a) size[a] = static_cast<int>(std::ceil(2 * radii[a] / j750[a])) + 2;
    return make_resin_volume(size, j750, [&](int x, int y, int z) -> int {
        const std::array<int, 3> at{x, y, z};
        std::array<double, 3> from_centre{};
        double r = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            from_centre[a] = (at[a] + 0.5 - 0.5 * size[a]) * j750[a];
            r += std::pow(from_centre[a] / radii[a], 2);
        }
        if (r > 1 || std::hypot(from_centre[1], from_centre[2]) < 0.25) return 0;
        const double depth = (1 - std::sqrt(r)) * *std::min_element(radii.begin(), radii.end());
        const auto address = static_cast<std::uint64_t>((z * size[1] + y) * size[0] + x);
        const double draw = voxtone::RandomStream(11, address).uniform();
        return depth < 0.4 && draw < 0.6 ? 1 + static_cast<int>(draw / 0.15) : 5;
    });
}

double rms(const Appearance& a, const Appearance& b) {
    REQUIRE(a.value.size() == b.value.size());
    double sum = 0;
    for (std::size_t i = 0; i < a.value.size(); ++i)
        sum += std::pow(double(a.value[i]) - double(b.value[i]), 2) / double(a.value.size());
    REQUIRE(std::isfinite(sum));
    return std::sqrt(sum);
}

}  // namespace

TEST_CASE("A body in tiles takes less memory and looks as it does whole, and what memory cannot hold is refused",
          "[slow]") {
    const ResinSet set = vero_opaque();
    const ResinVolume volume = halftoned_body({6, 1.1, 1.0});
    const Scene scene{&volume, &set, GENERATE(Backing::none, Backing::black), Sides::open};
    const Surface surface = find_surface(scene, {2, 1, 3}, SurfacePart::all);
    TransportOptions options;
    TransportSummary one_tile, tiles;
    const Appearance one = TransportPredictor(options).predict(scene, surface, one_tile);
    REQUIRE(one_tile.pieces == 1);
    options.tile_cells = surface.cells.size() / 3;
    const Appearance several = TransportPredictor(options).predict(scene, surface, tiles);
    CHECK(tiles.memory_bytes < one_tile.memory_bytes);
    CHECK(tiles.pieces > 1);
    options.memory_bytes = tiles.memory_bytes / 3;
    CHECK_THROWS_AS(TransportPredictor(options).predict(scene, surface), voxtone::ResourceError);
    CAPTURE(rms(one, several), tiles.pieces);
    CHECK(rms(one, several) < 0.001);
}

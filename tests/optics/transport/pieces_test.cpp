// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bodies that are predicted in pieces: what lies outside a piece's window is diffusion alone, whatever it holds and
// wherever the surface runs through it.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "voxtone/base/random.h"
#include "voxtone/optics/transport/optical_grid.h"
#include "voxtone/optics/transport/transport.h"

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

double largest_difference(const Appearance& a, const Appearance& b) {
    REQUIRE(a.value.size() == b.value.size());
    double worst = 0;
    for (std::size_t i = 0; i < a.value.size(); ++i) {
        REQUIRE(std::isfinite(b.value[i]));
        worst = std::max(worst, static_cast<double>(std::abs(a.value[i] - b.value[i])));
    }
    return worst;
}

}  // namespace

TEST_CASE("A curved body in pieces looks like the whole, wherever a window cuts its surface") {
    const ResinSet set = vero_opaque();
    const ResinVolume volume = halftoned_body({3.2, 0.9, 0.8});
    const Scene scene{&volume, &set, GENERATE(Backing::none, Backing::black), Sides::open};
    const Surface surface = find_surface(scene, {2, 1, 3}, SurfacePart::all);
    TransportOptions options;
    TransportSummary alone;
    const Appearance whole = TransportPredictor(options).predict(scene, surface, alone);
    REQUIRE(alone.pieces == 1);
    TransportSummary summary;
    options.halo_mm = 1;
    SECTION("of a given size") { options.piece_mm = 1.3; }
    SECTION("as large as memory allows") { options.memory_bytes = alone.memory_bytes * 4 / 5; }
    const Appearance pieces = TransportPredictor(options).predict(scene, surface, summary);
    CHECK(summary.pieces > 1);
    const double worst = largest_difference(whole, pieces);
    INFO("largest difference " << worst << " in " << summary.pieces << " pieces");
    CHECK(worst < 0.03);  // a halo of 1 mm on a body lit all around; of 5 mm: docs/predict.md
}

TEST_CASE("What a box of blocks takes is the sum over its blocks, and those outside of it") {
    const ResinSet set = vero_opaque();
    const ResinVolume volume = halftoned_body({1.9, 1.3, 1.1});
    const Scene scene{&volume, &set, Backing::none, Sides::open};
    const GridCensus census(scene, {});
    const auto& n = census.lattice;
    const std::size_t none = census.bytes({}, {});
    const auto more = [&](const std::array<int, 3>& begin, const std::array<int, 3>& end) {
        return census.bytes(begin, end) - none;
    };
    const auto one_by_one = [&](const std::array<int, 3>& begin, const std::array<int, 3>& end) {
        std::size_t sum = 0;
        for (int z = begin[2]; z < end[2]; ++z)
            for (int y = begin[1]; y < end[1]; ++y)
                for (int x = begin[0]; x < end[0]; ++x) sum += more({x, y, z}, {x + 1, y + 1, z + 1});
        return sum;
    };
    CHECK(none % GridCensus::least_bytes(1) == 0);
    REQUIRE(more({}, n) > 0);
    CHECK(more({}, n) == one_by_one({}, n));
    const std::array<int, 3> low{n[0] / 3, n[1] / 4, n[2] / 5}, high{n[0] - 1, n[1] / 2 + 1, n[2]};
    CHECK(more(low, high) == one_by_one(low, high));
    // Of one block: nothing more where it is air, as many cells as its kind has elsewhere.
    const OpticalGrid grid(scene, {});
    for (const GridBlock& block : grid.blocks) {
        const std::array<int, 3> at{block.at[0], block.at[1], block.at[2]};
        const std::size_t cells = block.kind == BlockKind::skin     ? 64 * 6 * (55 + 308 / 16)
                                  : block.kind == BlockKind::margin ? 64 * 55
                                                                    : 0;
        REQUIRE(more(at, {at[0] + 1, at[1] + 1, at[2] + 1}) == 56 * 460 + cells);
    }
    CHECK(none == grid.blocks.size() * GridCensus::least_bytes(1));
}

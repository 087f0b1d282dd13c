// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/coarse_cells.h"

#include <catch2/catch.hpp>

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

constexpr std::array<double, 3> pitch_mm{0.1, 0.1, 0.1};

/// Stairs along x, whose steps end within the larger cells.
optics::ResinVolume stairs() {
    return optics::make_resin_volume({20, 12, 30}, pitch_mm,
                                     [](int x, int, int z) { return z < 3 + 9 * (x / 7) ? 1 : 0; });
}

/// Every cell of the surface shows its own height.
SurfacePrediction heights(optics::Surface surface) {
    SurfacePrediction prediction;
    prediction.channels = 1;
    for (const optics::SurfaceCell& cell : surface.cells) {
        prediction.value.push_back(cell.centre_mm[2]);
        prediction.rgb.push_back(Eigen::Vector3f::Constant(cell.centre_mm[2]));
    }
    prediction.remarks = {"a remark"};
    prediction.surface = std::move(surface);
    return prediction;
}

}  // namespace

TEST_CASE("larger cells show the mean of the cells of the eye in them, also where a step goes through them") {
    const optics::ResinVolume volume = stairs();
    const optics::ResinSet resins = optics::vero_opaque();
    const optics::Scene scene{.volume = &volume, .resins = &resins};
    const auto cells = coarse_cells(pitch_mm, 0.5);
    REQUIRE(cells);
    CHECK(cells->eye == std::array<int, 3>{1, 1, 1});
    CHECK(cells->coarse == std::array<int, 3>{5, 5, 5});
    for (const auto part : {optics::SurfacePart::top, optics::SurfacePart::all}) {
        const optics::Surface large = optics::find_surface(scene, cells->coarse, part);
        const SurfacePrediction mean = averaged(heights(optics::find_surface(scene, cells->eye, part)), large, part);
        REQUIRE(mean.value.size() == large.cells.size());
        for (std::size_t i = 0; i < large.cells.size(); ++i) {
            if (part == optics::SurfacePart::top) CHECK(mean.value[i] == Approx(large.cells[i].centre_mm[2]));
            CHECK(mean.value[i] >= 0);
            CHECK(mean.value[i] <= Approx(2.1));
            CHECK(mean.rgb[i][1] == Approx(mean.value[i]));
        }
        CHECK(mean.remarks == std::vector<std::string>{"a remark"});
    }
    CHECK_FALSE(coarse_cells(pitch_mm, 0.1));
}

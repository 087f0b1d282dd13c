// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/mixture_body.h"

#include <catch2/catch.hpp>

#include "slicer/layers/plain_body.h"
#include "slicer/printer/placement.h"
#include "tests/slicer/layers/source_voxels.h"
#include "tests/slicer/mesh/shapes.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

const halftone::BlueNoiseScreen& screen() {
    static const halftone::BlueNoiseScreen one(std::array<double, 3>{0.05, 0.05, 0.05});
    return one;
}

}  // namespace

TEST_CASE("A box that is a mesh has the voxels of a plain one, of a resin and of a mixture") {
    const VoxelGrid grid = grid_around({0, 0, 0}, {2, 1.5, 2.2}, {0.05, 0.05, 0.05});
    const SolidMesh mesh = shapes::box({0, 0, 0}, {2, 1.5, 2.2});
    for (const std::vector<double>& shares : {std::vector<double>{0, 1, 0}, {1, 2, 1}}) {
        const PlainBody plain(grid, 0, cumulative_mixture(shares), 3, screen());
        const MixtureBody body(Solid(mesh, grid), MixtureFill(cumulative_mixture(shares), 3, screen()));
        CHECK(test::source_voxels(body) == test::source_voxels(plain));
    }
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/plain_body.h"

#include <cmath>

#include <catch2/catch.hpp>

#include "slicer/layers/composed_layers.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

const std::array<double, 3> pitch{25.4 / 600, 25.4 / 300, 0.027};
const halftone::BlueNoiseScreen& screen() {
    static const halftone::BlueNoiseScreen one(pitch);
    return one;
}

VoxelGrid grid_of(const std::array<int, 3>& size) {
    VoxelGrid grid;
    grid.pitch_mm = {pitch[0], pitch[1], pitch[2]};
    grid.size = size;
    return grid;
}

/// The voxels of a print, x fastest, from the lowest y and layer.
std::vector<int> made_by(const LayerSource& print) {
    const std::array<int, 3>& size = print.grid().size;
    std::vector<int> voxels(std::size_t(size[0] * size[1] * size[2]), -1);
    for (int slab = 0; slab * print.slab_layers() < size[2]; ++slab)
        (void)print.make(slab, 0, size[2], [&](int k, const io::LayerRuns& layer) {
            for (int j = 0; j < size[1]; ++j) {
                int i = 0;
                for (const io::Run& run : layer.row(std::uint32_t(size[1] - 1 - j)))
                    for (int n = 0; n < run.length; ++n)
                        voxels[std::size_t((k * size[1] + j) * size[0] + i++)] = run.material;
                REQUIRE(i == size[0]);
            }
        });
    return voxels;
}

/// By the share of all resins before it that a threshold is below.
int resin_at(const std::vector<double>& shares, int i, int j, int k) {
    double sum = 0, below = 0;
    for (const double share : shares) sum += share;
    const double threshold = screen().threshold(i, j, k);
    for (std::size_t r = 0; r + 1 < shares.size(); ++r) {
        below += shares[r];
        if (threshold < std::round(65536 * below / sum)) return int(r) + 1;
    }
    return int(shares.size());
}

}  // namespace

TEST_CASE("A cylinder has the voxels whose centres it holds, of the resins that the print's screen draws there") {
    const std::vector<double> shares{1, 0, 3};
    const std::array<int, 3> size{71, 35, 5}, at{5, 3, 2};
    const double diameter = GENERATE(0.0, 71 * 25.4 / 600, 2.4);
    CAPTURE(diameter);
    const auto body =
        std::make_shared<const PlainBody>(grid_of(size), diameter, cumulative_mixture(shares), 3, screen());
    const ComposedLayers print(grid_of({80, 40, 8}), {{body, at, 0, false}});
    const std::vector<int> voxels = made_by(print);
    std::size_t wrong = 0, filled = 0, v = 0;
    for (int k = 0; k < 8; ++k)
        for (int j = 0; j < 40; ++j)
            for (int i = 0; i < 80; ++i, ++v) {
                const bool in_box = i >= at[0] && j >= at[1] && k >= at[2] && i < at[0] + size[0] &&
                                    j < at[1] + size[1] && k < at[2] + size[2];
                const double x = (i - at[0] + 0.5) * pitch[0] - size[0] * pitch[0] / 2,
                             y = (j - at[1] + 0.5) * pitch[1] - size[1] * pitch[1] / 2;
                const bool in = in_box && (diameter == 0 || std::hypot(x, y) <= diameter / 2);
                filled += in;
                wrong += voxels[v] != (in ? resin_at(shares, i, j, k) : 0);
            }
    CHECK(wrong == 0);
    CHECK(body->voxels_of_layer() * 5 == filled);
    CHECK(filled > 1000);
}

TEST_CASE("A mixture takes its shares of a box, a resin alone all of it") {
    const auto shares_in = [](const std::vector<double>& shares) {
        const PlainBody body(grid_of({64, 64, 64}), 0, cumulative_mixture(shares), int(shares.size()), screen());
        std::vector<double> found(shares.size() + 1);
        for (const int material : made_by(body)) found[std::size_t(material)] += 1.0 / (64 * 64 * 64);
        return found;
    };
    const std::vector<double> half = shares_in({2, 1, 1});
    CHECK(half[0] == 0);
    CHECK(half[1] == Approx(0.5).margin(4.0 / (64 * 64 * 64)));
    CHECK(half[2] == Approx(0.25).margin(4.0 / (64 * 64 * 64)));
    CHECK(shares_in({0, 5, 0}) == std::vector<double>{0, 0, 1, 0});
    CHECK(shares_in({0, 0, 1}) == std::vector<double>{0, 0, 0, 1});
    CHECK(shares_in({1, 0, 0}) == std::vector<double>{0, 1, 0, 0});
    CHECK(shares_in({1}) == std::vector<double>{0, 1});
}

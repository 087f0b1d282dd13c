// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every part of a prediction that takes long on a large body looks at once whether it is still wanted: a request to
// stop waits for no sweep, no solve and no grid.
#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <vector>

#include "base/error.h"
#include "optics/grid/homogenisation.h"
#include "optics/grid/viewing_faces.h"
#include "optics/grid/viewing_grid_builder.h"
#include "optics/monte_carlo/monte_carlo.h"
#include "optics/transport/transport.h"
#include "optics/transport/transport_sweep.h"
#include "optics/transport/viewing_diffusion.h"
#include "optics/transport/viewing_sequence.h"
#include "tests/counted_parts.h"

using namespace voxtone::optics;
using voxtone::Cancelled;
using voxtone::Progress;

namespace {

/// A slab of two resins, and somebody who has asked to stop.
struct Stopped {
    ResinSet resins = vero_opaque();
    ResinVolume volume = make_resin_volume({32, 16, 48}, {0.0423333, 0.0846667, 0.027},
                                           [](int x, int, int z) { return z > 40 && x % 3 == 0 ? 1 : 5; });
    Scene scene{&volume, &resins, Backing::none, Sides::open};
    std::array<int, 3> view{2, 1, 3};
    Surface surface = find_surface(scene, view, SurfacePart::all);
    Progress stop;
    Stopped() { stop.cancel(); }

    [[nodiscard]] ViewingWindow whole() const { return {{}, BlockLattice(volume.size(), view).blocks, {}}; }
    [[nodiscard]] static TransportOptions on_viewing_cells() {
        TransportOptions options;
        options.refinement = Refinement::none;
        return options;
    }
    [[nodiscard]] ViewingGrid grid(const Progress* progress) const {
        return make_viewing_grid(scene, view, {0.5}, {}, whole(), &surface, progress);
    }
};

}  // namespace

TEST_CASE("A surface is not looked for any more once that is cancelled", "[cancellation]") {
    const Stopped stopped;
    for (const SurfacePart part : {SurfacePart::all, SurfacePart::top})
        CHECK_THROWS_AS((void)find_surface(stopped.scene, stopped.view, part, &stopped.stop), Cancelled);
}

TEST_CASE("Grids are not made any more once that is cancelled", "[cancellation]") {
    Stopped stopped;
    CHECK_THROWS_AS((void)stopped.grid(&stopped.stop), Cancelled);

    ViewingGrid grid = stopped.grid(nullptr);
    std::vector<std::uint8_t> wanted;
    CHECK_THROWS_AS((void)homogenise(grid, stopped.volume, wanted, &stopped.stop), Cancelled);
    CHECK_THROWS_AS((void)find_viewing_faces(grid, stopped.surface, &stopped.stop), Cancelled);
}

TEST_CASE("A sweep and a solve of diffusion leave off in the middle", "[cancellation]") {
    const Stopped stopped;
    const ViewingGrid grid = stopped.grid(nullptr);
    const std::vector<TransportMedium> mixtures(grid.mixtures.size(), TransportMedium{20, 18});
    const std::vector<SweepMedium> media = sweep_media(grid.directions, grid.edge_mm(), 1, mixtures);
    const std::vector<Moments> light(grid.cells(), Moments{1, 0, 0, 0});
    std::vector<Moments> sum(grid.cells());
    const std::vector<Octet> in(4 * grid.open_faces.size());
    std::vector<Octet> out(in.size());
    const std::vector<std::array<float, 2>> core_in(grid.core_faces.size());
    std::vector<float> core_out(4 * grid.core_faces.size());
    const SweepRows rows = sweep_rows(grid, false, 1);
    SweepJob job{.grid = grid,
                 .cells = {.media = media, .light = light, .sum = sum},
                 .parts = {},
                 .in = in,
                 .out = out,
                 .core_in = core_in,
                 .core_out = core_out,
                 .rows = rows};
    job.progress = &stopped.stop;
    CHECK_THROWS_AS(sweep_half(job, false), Cancelled);
    for (const Moments& m : sum) REQUIRE(m.phi == 0);
    job.progress = nullptr;
    sweep_half(job, false);
    CHECK(std::any_of(sum.begin(), sum.end(), [](const Moments& m) { return m.phi > 0; }));

    ViewingDiffusion diffusion(grid);
    const std::vector<float> D(grid.mixtures.size(), 0.1f), D_core(stopped.resins.resins.size() + 1, 0.1f),
        loss(grid.cells(), 0.1f), core_loss(grid.core_block.size(), 0.1f);
    std::vector<BlockStencil<4>> blocks(grid.transport_blocks.size());
    CHECK_THROWS_AS(diffusion.prepare(D, D_core, loss, core_loss, blocks, &stopped.stop), Cancelled);
    diffusion.prepare(D, D_core, loss, core_loss, blocks);
    struct Room {
        std::vector<float> cells, core;
        ViewingDiffusion::Vector vector() { return {cells, core}; }
    };
    const Room nothing{std::vector<float>(grid.cells()), std::vector<float>(grid.core_block.size())};
    Room x = nothing, right = nothing, p = nothing, z = nothing;
    std::fill(right.cells.begin(), right.cells.end(), 1.0f);
    CHECK_THROWS_AS(diffusion.solve(x.vector(), right.vector(), p.vector(), z.vector(), 1e-3, 10, &stopped.stop),
                    Cancelled);
    for (const float v : x.cells) REQUIRE(v == 0);
    CHECK(diffusion.solve(x.vector(), right.vector(), p.vector(), z.vector(), 1e-3, 10) > 0);
}

TEST_CASE("A cancelled prediction does not even begin", "[cancellation]") {
    const Stopped stopped;
    TransportSummary summary;
    CHECK_THROWS_AS((void)TransportPredictor().predict(stopped.scene, stopped.surface, summary, &stopped.stop),
                    Cancelled);
    CHECK(summary.cells == 0);  // no grid was made first
    CHECK(summary.diffusion_s == 0);
    const TransportPredictor coarse(Stopped::on_viewing_cells());
    CHECK_THROWS_AS((void)coarse.predict(stopped.scene, stopped.surface, &stopped.stop), Cancelled);
    CHECK_THROWS_AS((void)coarse.sequence(stopped.scene, stopped.surface, &stopped.stop), Cancelled);
    CHECK_THROWS_AS((void)MonteCarlo().predict(stopped.scene, stopped.surface, &stopped.stop), Cancelled);
}

TEST_CASE("A sequence that is cancelled solves nothing first", "[cancellation]") {
    const Stopped stopped;
    ViewingSequence sequence(stopped.scene, stopped.surface, Stopped::on_viewing_cells());
    CHECK_THROWS_AS((void)sequence.next(stopped.volume, &stopped.stop), Cancelled);
    CHECK(sequence.summary().diffusion_s == 0);

    ViewingSequence seen(stopped.scene, stopped.surface, Stopped::on_viewing_cells());
    std::vector<float> seed = seen.next(stopped.volume).value;
    const double diffusion_s = seen.summary().diffusion_s;
    CHECK_THROWS_AS((void)seen.gradient(
                        seed, [](const ResinGradient&, const VoxelBox&) { FAIL("nothing to visit"); }, &stopped.stop),
                    Cancelled);
    CHECK(seen.summary().diffusion_s == diffusion_s);
}

TEST_CASE("A prediction tells how far it is, sweep by sweep and path by path, to its end and never back") {
    const Stopped slab;
    const auto told_by = [](const auto& work) {
        const voxtone::test::CountedParts parts;
        work(&parts);
        const std::vector<double> told = parts.told.back();
        CHECK(std::ranges::is_sorted(told));
        REQUIRE_FALSE(told.empty());
        CHECK(told.front() < 0.26);
        CHECK(told.back() == Approx(1));
        double longest = told.front();
        for (std::size_t i = 1; i < told.size(); ++i) longest = std::max(longest, told[i] - told[i - 1]);
        CHECK(longest < 0.26);
        return told.size();
    };
    const std::size_t channels = slab.resins.channels.size();
    CHECK(told_by([&](const Progress* progress) {
              (void)TransportPredictor().predict_with_twin(slab.scene, slab.surface, slab.volume, progress);
          }) >= 4 * channels);
    ViewingSequence sequence(slab.scene, slab.surface, Stopped::on_viewing_cells());
    std::vector<float> seed;
    CHECK(told_by([&](const Progress* progress) { seed = sequence.next(slab.volume, progress).value; }) >=
          2 * channels);
    CHECK(told_by([&](const Progress* progress) {
              (void)sequence.gradient(
                  seed, [](const ResinGradient&, const VoxelBox&) {}, progress);
          }) >= 2 * channels);
    TransportOptions tiles = Stopped::on_viewing_cells();
    tiles.tile_cells = 8, tiles.tile_halo = 4;
    CHECK(told_by([&](const Progress* progress) {
              (void)TransportPredictor(tiles).predict(slab.scene, slab.surface, progress);
          }) > 3 * channels);
    CHECK(told_by([&](const Progress* progress) {
              (void)MonteCarlo({.paths = 200}).predict_with_twin(slab.scene, slab.surface, slab.volume, progress);
          }) >= 8);
}

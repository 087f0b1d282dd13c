// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every part of a prediction that takes long on a large body looks at once whether it is still wanted: a request to
// stop waits for no sweep, no solve and no grid.
#include <catch2/catch.hpp>

#include <array>
#include <vector>

#include "voxtone/base/error.h"
#include "voxtone/optics/monte_carlo/monte_carlo.h"
#include "voxtone/optics/transport/coarse/viewing_faces.h"
#include "voxtone/optics/transport/coarse/viewing_grid_builder.h"
#include "voxtone/optics/transport/coarse/viewing_palette.h"
#include "voxtone/optics/transport/coarse/viewing_sequence.h"
#include "voxtone/optics/transport/diffusion.h"
#include "voxtone/optics/transport/transport.h"
#include "voxtone/optics/transport/transport_channel.h"
#include "voxtone/optics/transport/transport_sweep.h"

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

    [[nodiscard]] GridOptions grid_options() const {
        GridOptions options;
        options.view_voxels = view;
        options.skin_voxels = {1, 1, 1};
        return options;
    }
    [[nodiscard]] ViewingWindow whole() const { return {{}, BlockLattice(volume.size(), view).blocks, {}}; }
    [[nodiscard]] static TransportOptions on_viewing_cells() {
        TransportOptions options;
        options.viewing_cells = true;
        return options;
    }
    [[nodiscard]] TransportChannel::MediaByKind media(const OpticalGrid& grid) const {
        TransportChannel::MediaByKind media;
        const TransportMedium grey{20, 18};
        media[0].assign(grid.palette.size(), grey);
        media[1] = media[0];
        media[2].assign(grid.palette.size(), grey);
        return media;
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
    const auto make = [&](const Progress* progress) {
        return make_viewing_grid(stopped.scene, stopped.view, 0.5, {}, stopped.whole(), &stopped.surface, progress);
    };
    CHECK_THROWS_AS((void)make(&stopped.stop), Cancelled);
    CHECK_THROWS_AS(OpticalGrid(stopped.scene, stopped.grid_options(), &stopped.stop), Cancelled);
    CHECK_THROWS_AS(GridCensus(stopped.scene, stopped.grid_options(), &stopped.stop), Cancelled);

    ViewingGrid grid = make(nullptr);
    std::vector<std::uint8_t> wanted;
    CHECK_THROWS_AS((void)fill(grid, stopped.volume, wanted, &stopped.stop), Cancelled);
    CHECK_THROWS_AS((void)see(grid, stopped.surface, &stopped.stop), Cancelled);
}

TEST_CASE("A sweep and a solve of diffusion leave off in the middle", "[cancellation]") {
    const Stopped stopped;
    const OpticalGrid grid(stopped.scene, stopped.grid_options());
    CHECK_THROWS_AS(DiffusionPlan(grid, &stopped.stop), Cancelled);

    const TransportChannel::MediaByKind media = stopped.media(grid);
    const std::vector<Moments> light(grid.medium.size(), Moments{1, 0, 0, 0});
    std::vector<Moments> sum(grid.medium.size());
    const std::vector<Octet> in(4 * grid.faces.size());
    std::vector<Octet> out(in.size());
    SweepJob job{&grid, {media[0], media[1]}, light, sum, in, out};
    job.progress = &stopped.stop;
    CHECK_THROWS_AS(sweep_half(job, false), Cancelled);
    for (const Moments& m : sum) REQUIRE(m.phi == 0);
    job.progress = nullptr;
    sweep_half(job, false);
    CHECK(sum[sum.size() / 2].phi > 0);

    const DiffusionPlan plan(grid);
    const std::vector<float> conductance(grid.contacts.size(), 1.0f), loss(grid.nodes.size(), 0.1f),
        right(grid.nodes.size(), 1.0f);
    std::vector<float> x(grid.nodes.size(), 0.0f);
    const Diffusion diffusion(plan, conductance, loss);
    CHECK_THROWS_AS(diffusion.solve(right, x, 1e-3, 10, &stopped.stop), Cancelled);
    for (const float v : x) REQUIRE(v == 0);
    CHECK(diffusion.solve(right, x, 1e-3, 10) > 0);

    CHECK_THROWS_AS(TransportChannel(grid, plan, media, TransportOptions{}, &stopped.stop), Cancelled);
}

TEST_CASE("A cancelled prediction does not even begin", "[cancellation]") {
    const Stopped stopped;
    TransportSummary summary;
    CHECK_THROWS_AS((void)TransportPredictor().predict(stopped.scene, stopped.surface, summary, &stopped.stop),
                    Cancelled);
    CHECK(summary.skin_cells == 0);  // no grid was made first
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
